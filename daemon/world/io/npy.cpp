#include "daemon/world/io/npy.hpp"

#include <utility>
#include <vector>

#include "daemon/world/io/npy_header.hpp"
#include "daemon/world/io/read_items.hpp"

namespace thimble::world {
namespace {

[[nodiscard]] tl::unexpected<Error> ends_early(const char* field) {
  return fail(Errc::Malformed, std::string(field) + ": the file ends before it does");
}

[[nodiscard]] Result<NpyHeader> read_header(ByteSource& source, std::uint64_t& header_bytes) {
  std::vector<std::byte> bytes(kNpyMaxPreambleBytes);
  // Version 1.0 has two bytes less; the text of its header is longer than that in any case.
  const auto count = source.read(bytes);
  if (!count) return tl::unexpected(count.error());
  bytes.resize(*count);
  const auto preamble = parse_npy_preamble(bytes);
  if (!preamble) return tl::unexpected(preamble.error());
  header_bytes = std::uint64_t{preamble->preamble_bytes} + preamble->text_bytes;
  if (header_bytes > source.size()) return ends_early("header");
  if (header_bytes < bytes.size()) {
    return fail(Errc::Malformed, "header length: too small to hold a header");
  }
  const std::size_t start = bytes.size();
  bytes.resize(static_cast<std::size_t>(header_bytes));
  const auto rest = source.read(std::span(bytes).subspan(start));
  if (!rest) return tl::unexpected(rest.error());
  if (*rest != bytes.size() - start) return ends_early("header");
  const auto text = std::span(bytes).subspan(preamble->preamble_bytes);
  return parse_npy_text({reinterpret_cast<const char*>(text.data()), text.size()});
}

[[nodiscard]] Result<void> check_length(const ByteSource& source, const NpyHeader& header,
                                        std::uint64_t header_bytes) {
  // At most 2^33: 1024^3 items of 8 bytes.
  const std::uint64_t expected = header_bytes + std::uint64_t{header.item_bytes} * header.shape[0] *
                                                    header.shape[1] * header.shape[2];
  if (source.size() == expected) return {};
  return fail(Errc::Malformed, "data: the file has " + std::to_string(source.size()) +
                                   " bytes, header and shape ask for " + std::to_string(expected));
}

// What the file holds, after everything that can be told from its header and its length.
[[nodiscard]] Result<NpyHeader> read_checked_header(ByteSource& source) {
  std::uint64_t header_bytes = 0;
  auto header = read_header(source, header_bytes);
  if (!header) return header;
  const auto checked = check_length(source, *header, header_bytes);
  if (!checked) return tl::unexpected(checked.error());
  return header;
}

[[nodiscard]] VolumeShape shape_of(const NpyHeader& header) {
  VolumeShape shape{.sizes = header.shape};
  if (!header.is_fortran_order) shape.fastest = {2, 1, 0};
  return shape;
}

}  // namespace

Result<void> read_npy(ByteSource& source, const SinkMaker& make_sink) {
  const auto header = read_checked_header(source);
  if (!header) return tl::unexpected(header.error());
  const auto sink = make_sink(shape_of(*header));
  if (!sink) return tl::unexpected(sink.error());
  return read_items(source, {header->kind, header->item_bytes, header->is_big_endian}, **sink);
}

Result<VolumeShape> read_npy_shape(ByteSource& source) {
  const auto header = read_checked_header(source);
  if (!header) return tl::unexpected(header.error());
  return shape_of(*header);
}

Result<VoxelGrid> load_npy(ByteSource& source, const VolumeOptions& options,
                           MaterialMap* materials) {
  return write_volume([&](const SinkMaker& make_sink) { return read_npy(source, make_sink); },
                      options, materials);
}

Result<VoxelGrid> load_npy_file(const std::string& path, const VolumeOptions& options,
                                MaterialMap* materials) {
  const auto source = open_file(path);
  if (!source) return tl::unexpected(source.error().in(path));
  auto grid = load_npy(**source, options, materials);
  if (!grid) return tl::unexpected(grid.error().in(path));
  return grid;
}

Result<void> check_npy_file(const std::string& path, const VolumeOptions& options) {
  const auto source = open_file(path);
  if (!source) return tl::unexpected(source.error().in(path));
  const auto shape = read_npy_shape(**source);
  if (!shape) return tl::unexpected(shape.error().in(path));
  const auto checked = VolumeWriter::check(*shape, options);
  if (!checked) return tl::unexpected(checked.error().in(path));
  return {};
}

}  // namespace thimble::world
