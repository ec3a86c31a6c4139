#include "daemon/world/io/nrrd.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/world/io/buffered_source.hpp"
#include "daemon/world/io/gunzip_stream.hpp"
#include "daemon/world/io/nrrd_header.hpp"
#include "daemon/world/io/read_items.hpp"
#include "daemon/world/io/text_items.hpp"

namespace thimble::world {
namespace {

[[nodiscard]] tl::unexpected<Error> malformed(std::string message) {
  return fail(Errc::Malformed, std::move(message));
}

// A volume whose header is read and whose data can be read next.
class NrrdFile {
 public:
  [[nodiscard]] Result<void> open(ByteSource& source, const DataOpener& open_data);
  [[nodiscard]] Result<VolumeShape> shape(const VolumeOptions& options) const;
  [[nodiscard]] Result<void> read(NumberSink& sink);

 private:
  [[nodiscard]] Result<void> read_header();
  [[nodiscard]] Result<void> skip_lines();
  [[nodiscard]] Result<void> check_length() const;
  [[nodiscard]] Result<void> read_raw(NumberSink& sink);
  [[nodiscard]] Result<void> read_gzip(NumberSink& sink);
  [[nodiscard]] Result<void> read_text(NumberSink& sink);
  [[nodiscard]] std::uint64_t items() const noexcept {
    return std::uint64_t{header_.sizes[0]} * header_.sizes[1] * header_.sizes[2];
  }
  [[nodiscard]] std::uint64_t data_bytes() const noexcept { return items() * header_.type.bytes; }
  [[nodiscard]] std::uint64_t byte_skip() const noexcept {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(0, header_.byte_skip));
  }

  NrrdHeader header_{};
  std::unique_ptr<ByteSource> detached_{};
  std::optional<BufferedSource> data_{};
};

Result<void> NrrdFile::read_header() {
  const auto ahead = data_->peek();
  if (!ahead) return tl::unexpected(ahead.error());
  const std::string_view text(reinterpret_cast<const char*>(ahead->data()), ahead->size());
  auto header = parse_nrrd_header(text, text.size() == data_->size());
  if (!header) return tl::unexpected(header.error());
  header_ = *std::move(header);
  data_->take(header_.header_bytes);
  return {};
}

Result<void> NrrdFile::open(ByteSource& source, const DataOpener& open_data) {
  data_.emplace(source);
  if (auto read = read_header(); !read) return read;
  if (!header_.data_file.empty()) {
    auto opened = open_data(header_.data_file);
    if (!opened) return tl::unexpected(opened.error());
    detached_ = *std::move(opened);
    data_.emplace(*detached_);
  }
  if (auto skipped = skip_lines(); !skipped) return skipped;
  return check_length();
}

Result<void> NrrdFile::skip_lines() {
  for (std::uint32_t left = header_.line_skip; left > 0;) {
    const auto ahead = data_->peek();
    if (!ahead) return tl::unexpected(ahead.error());
    if (ahead->empty()) {
      return malformed("line skip: the data file has " + std::to_string(header_.line_skip - left) +
                       " lines to skip, expected " + std::to_string(header_.line_skip));
    }
    const auto end = std::find(ahead->begin(), ahead->end(), std::byte{'\n'});
    const bool is_line = end != ahead->end();
    data_->take(static_cast<std::size_t>(end - ahead->begin()) + (is_line ? 1 : 0));
    if (is_line) --left;
  }
  return {};
}

// What the length alone can disprove, before anything is allocated.
Result<void> NrrdFile::check_length() const {
  const std::uint64_t has = data_->size();
  const auto say = [&](const std::string& wanted) {
    return malformed("data: the file has " + std::to_string(has) + " bytes for it, sizes ask for " +
                     wanted);
  };
  switch (header_.encoding) {
    case NrrdEncoding::Raw: {
      const std::uint64_t wanted = data_bytes() + byte_skip();
      if (header_.byte_skip < 0 ? has >= wanted : has == wanted) return {};
      return say(std::to_string(wanted));
    }
    case NrrdEncoding::Gzip: {
      const std::uint64_t wanted = (data_bytes() + byte_skip()) / kMaxGunzipRatio;
      if (has >= wanted) return {};
      return say("at least " + std::to_string(wanted) + ", however well compressed");
    }
    case NrrdEncoding::Text:
      // One digit and a blank each, the last one without.
      if (has >= byte_skip() && has - byte_skip() >= 2 * items() - 1) return {};
      return say("at least " + std::to_string(byte_skip() + 2 * items() - 1));
  }
  return {};
}

Result<VolumeShape> NrrdFile::shape(const VolumeOptions& options) const {
  VolumeShape shape{.sizes = header_.sizes};
  if (header_.spacing) {
    shape.spacing = *header_.spacing;
  } else if (header_.has_axis_bounds && !options.spacing) {
    return fail(Errc::Unsupported,
                "axis mins, axis maxs: say the spacing in a way that is not read; give it in the "
                "configuration");
  }
  return shape;
}

Result<void> NrrdFile::read(NumberSink& sink) {
  if (header_.encoding == NrrdEncoding::Gzip) return read_gzip(sink);
  return header_.encoding == NrrdEncoding::Text ? read_text(sink) : read_raw(sink);
}

Result<void> NrrdFile::read_raw(NumberSink& sink) {
  const auto skipped = data_->skip(data_->size() - std::min(data_->size(), data_bytes()));
  if (!skipped) return tl::unexpected(skipped.error());
  return read_items(*data_, header_.type, sink);
}

Result<void> NrrdFile::read_gzip(NumberSink& sink) {
  GunzipStream stream(*data_);
  std::vector<std::byte> dropped(
      static_cast<std::size_t>(std::min<std::uint64_t>(byte_skip(), BufferedSource::kAhead)));
  for (std::uint64_t left = byte_skip(); left > 0;) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(left, dropped.size()));
    const auto got = stream.read(std::span(dropped).first(count));
    if (!got) return tl::unexpected(got.error());
    if (*got != count) {
      return malformed("byte skip: the data has " + std::to_string(byte_skip() - left + *got) +
                       " bytes to skip, expected " + std::to_string(byte_skip()));
    }
    left -= count;
  }
  if (auto read = read_items(stream, header_.type, sink); !read) return read;
  // One byte more tells a bomb; the rest of it is never unpacked.
  std::array<std::byte, 1> more{};
  const auto got = stream.read(more);
  if (!got) return tl::unexpected(got.error());
  if (*got != 0) {
    return malformed("data: holds more than the " + std::to_string(data_bytes()) +
                     " bytes that sizes ask for");
  }
  return {};
}

Result<void> NrrdFile::read_text(NumberSink& sink) {
  const auto skipped = data_->skip(byte_skip());
  if (!skipped) return tl::unexpected(skipped.error());
  if (auto read = read_text_items(*data_, header_.type, sink); !read) return read;
  const auto is_over = is_text_over(*data_);
  if (!is_over) return tl::unexpected(is_over.error());
  if (*is_over) return {};
  return malformed("data: holds more than the " + std::to_string(items()) +
                   " numbers that sizes ask for");
}

}  // namespace

DataOpener beside(const std::string& path) {
  const auto slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "./" : path.substr(0, slash + 1);
  return [folder](const std::string& name) -> Result<std::unique_ptr<ByteSource>> {
    auto source = open_file_below(folder, name);
    if (!source) return tl::unexpected(source.error().in("data file: " + folder + name));
    return source;
  };
}

Result<void> read_nrrd(ByteSource& source, const DataOpener& open_data,
                       const VolumeOptions& options, const SinkMaker& make_sink) {
  NrrdFile file;
  if (auto opened = file.open(source, open_data); !opened) return tl::unexpected(opened.error());
  const auto shape = file.shape(options);
  if (!shape) return tl::unexpected(shape.error());
  const auto sink = make_sink(*shape);
  if (!sink) return tl::unexpected(sink.error());
  return file.read(**sink);
}

Result<VoxelGrid> load_nrrd(ByteSource& source, const DataOpener& open_data,
                            const VolumeOptions& options, MaterialMap* materials) {
  return write_volume(
      [&](const SinkMaker& make_sink) { return read_nrrd(source, open_data, options, make_sink); },
      options, materials);
}

Result<VoxelGrid> load_nrrd_file(const std::string& path, const VolumeOptions& options,
                                 MaterialMap* materials) {
  const auto source = open_file(path);
  if (!source) return tl::unexpected(source.error().in(path));
  auto grid = load_nrrd(**source, beside(path), options, materials);
  if (!grid) return tl::unexpected(grid.error().in(path));
  return grid;
}

Result<VolumeShape> read_nrrd_shape(ByteSource& source, const DataOpener& open_data,
                                    const VolumeOptions& options) {
  NrrdFile file;
  if (auto opened = file.open(source, open_data); !opened) return tl::unexpected(opened.error());
  return file.shape(options);
}

Result<void> check_nrrd_file(const std::string& path, const VolumeOptions& options) {
  const auto source = open_file(path);
  if (!source) return tl::unexpected(source.error().in(path));
  const auto shape = read_nrrd_shape(**source, beside(path), options);
  if (!shape) return tl::unexpected(shape.error().in(path));
  const auto checked = VolumeWriter::check(*shape, options);
  if (!checked) return tl::unexpected(checked.error().in(path));
  return {};
}

}  // namespace thimble::world
