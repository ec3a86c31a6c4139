#include "daemon/world/io/field_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "daemon/world/io/npy.hpp"

namespace thimble::world {
namespace {

constexpr double kAbsurd_m = 1e6;

using Numbers = std::array<std::uint32_t, 3>;

// Puts each number of the file where it belongs in the world.
class FieldWriter final : public NumberSink {
 public:
  [[nodiscard]] static Result<FieldWriter> create(const VolumeShape& shape,
                                                  const FieldOptions& options) {
    FieldWriter writer(shape, options);
    if (auto good = writer.check(); !good) return tl::unexpected(good.error());
    writer.left_ = std::uint64_t{shape.sizes[0]} * shape.sizes[1] * shape.sizes[2];
    writer.distances_m_.resize(static_cast<std::size_t>(writer.left_));
    return writer;
  }
  [[nodiscard]] static Result<void> check(const VolumeShape& shape, const FieldOptions& options) {
    return FieldWriter(shape, options).check();
  }

  [[nodiscard]] std::uint64_t items_left() const noexcept override { return left_; }
  [[nodiscard]] Result<void> put(std::span<const double> values) override {
    for (const double value : values) {
      std::array<std::size_t, 3> at{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool is_reversed = options_.volume.is_reversed[axis];
        at[world_axis(axis)] = is_reversed ? shape_.sizes[axis] - 1 - at_[axis] : at_[axis];
      }
      const double distance_m = value * options_.unit_m;
      // What no float need hold is no distance, which the field says of it.
      const bool is_sane = std::abs(distance_m) <= kAbsurd_m;
      distances_m_[(at[2] * numbers_[1] + at[1]) * numbers_[0] + at[0]] =
          is_sane ? static_cast<float>(distance_m) : std::numeric_limits<float>::infinity();
      advance();
    }
    left_ -= values.size();
    return {};
  }
  [[nodiscard]] Result<DistanceField> finish() && {
    return DistanceField::create(numbers_, step_m(), std::move(distances_m_), options_.center);
  }

 private:
  FieldWriter(const VolumeShape& shape, const FieldOptions& options)
      : shape_(shape), options_(options) {
    for (std::size_t axis = 0; axis < 3; ++axis) numbers_[world_axis(axis)] = shape.sizes[axis];
  }

  [[nodiscard]] std::size_t world_axis(std::size_t axis) const noexcept {
    return options_.volume.axis_order[axis];
  }
  // As cells of occupancy: the longest axis spans the workspace.
  [[nodiscard]] double step_m() const noexcept {
    const double longest = *std::max_element(numbers_.begin(), numbers_.end());
    return options_.volume.cell_m.value_or(options_.volume.workspace_m / longest);
  }
  [[nodiscard]] Result<void> check() const {
    const auto spacing = options_.volume.spacing.value_or(shape_.spacing);
    if (spacing[0] != spacing[1] || spacing[0] != spacing[2]) {
      return fail(Errc::Unsupported,
                  "spacing: distances are read of cubes only, and the axes differ");
    }
    return DistanceField::check(numbers_, step_m());
  }
  void advance() noexcept {
    for (const std::size_t axis : shape_.fastest) {
      if (++at_[axis] < shape_.sizes[axis]) return;
      at_[axis] = 0;
    }
  }

  VolumeShape shape_;
  FieldOptions options_;
  Numbers numbers_{};
  std::vector<float> distances_m_{};
  Numbers at_{};  // index along each axis of the file
  std::uint64_t left_{0};
};

template <class Read>
[[nodiscard]] Result<DistanceField> write_field(const Read& read, const FieldOptions& options) {
  std::optional<FieldWriter> writer;
  const Result<void> done = read([&](const VolumeShape& shape) -> Result<NumberSink*> {
    auto made = FieldWriter::create(shape, options);
    if (!made) return tl::unexpected(made.error());
    writer.emplace(std::move(*made));
    return &*writer;
  });
  if (!done) return tl::unexpected(done.error());
  return std::move(*writer).finish();
}

[[nodiscard]] bool is_npy(const std::string& path) { return path.ends_with(".npy"); }

}  // namespace

Result<DistanceField> load_npy_field(ByteSource& source, const FieldOptions& options) {
  return write_field([&](const SinkMaker& make_sink) { return read_npy(source, make_sink); },
                     options);
}

Result<DistanceField> load_nrrd_field(ByteSource& source, const DataOpener& open_data,
                                      const FieldOptions& options) {
  return write_field(
      [&](const SinkMaker& make_sink) {
        return read_nrrd(source, open_data, options.volume, make_sink);
      },
      options);
}

Result<DistanceField> load_field_file(const std::string& path, const FieldOptions& options) {
  const auto source = open_file(path);
  if (!source) return tl::unexpected(source.error().in(path));
  auto field = is_npy(path) ? load_npy_field(**source, options)
                            : load_nrrd_field(**source, beside(path), options);
  if (!field) return tl::unexpected(field.error().in(path));
  return field;
}

Result<void> check_field_file(const std::string& path, const FieldOptions& options) {
  const auto source = open_file(path);
  if (!source) return tl::unexpected(source.error().in(path));
  const auto shape = is_npy(path) ? read_npy_shape(**source)
                                  : read_nrrd_shape(**source, beside(path), options.volume);
  if (!shape) return tl::unexpected(shape.error().in(path));
  if (auto good = FieldWriter::check(*shape, options); !good) {
    return tl::unexpected(good.error().in(path));
  }
  return {};
}

}  // namespace thimble::world
