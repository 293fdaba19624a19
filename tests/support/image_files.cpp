// Encoding for tests: errors of the libraries end the test program, which is what a test wants.
#include "tests/support/image_files.hpp"

#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>  // needs <cstdio> before it

#include <png.h>

namespace hemiray::test {
namespace {

extern "C" void hemiray_test_append(png_structp png, png_bytep data, png_size_t count) {
  auto* bytes = static_cast<Bytes*>(png_get_io_ptr(png));
  bytes->insert(bytes->end(), data, data + count);
}

extern "C" void hemiray_test_fail(png_structp /*png*/, png_const_charp text) {
  std::fprintf(stderr, "cannot make a PNG: %s\n", text);
  std::abort();
}

}  // namespace

Bytes make_png(const PngSpec& spec) {
  Bytes bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, hemiray_test_fail, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &bytes, hemiray_test_append, nullptr);
  png_set_IHDR(png, info, spec.width, spec.height, spec.bit_depth, spec.color_type,
               spec.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  std::vector<png_color> palette;
  for (const auto& color : spec.palette) palette.push_back({color[0], color[1], color[2]});
  if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  if (!spec.palette_alpha.empty()) {
    png_set_tRNS(png, info, spec.palette_alpha.data(), static_cast<int>(spec.palette_alpha.size()), nullptr);
  }
  if (spec.transparent_grey) {
    png_color_16 color{};
    color.gray = *spec.transparent_grey;
    png_set_tRNS(png, info, nullptr, 0, &color);
  }
  png_write_info(png, info);
  const std::size_t row_bytes = png_get_rowbytes(png, info);
  Bytes copy = spec.rows;
  if (copy.size() != row_bytes * spec.height) hemiray_test_fail(png, "rows of another size");
  std::vector<png_bytep> rows;
  for (std::size_t y = 0; y < spec.height; ++y) rows.push_back(copy.data() + y * row_bytes);
  png_write_image(png, rows.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

Bytes make_jpeg(const JpegSpec& spec) {
  jpeg_compress_struct codec{};
  jpeg_error_mgr errors{};
  codec.err = jpeg_std_error(&errors);
  jpeg_create_compress(&codec);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&codec, &data, &size);
  codec.image_width = spec.width;
  codec.image_height = spec.height;
  codec.input_components = spec.components;
  codec.in_color_space = spec.components == 1 ? JCS_GRAYSCALE : spec.components == 3 ? JCS_RGB : JCS_CMYK;
  jpeg_set_defaults(&codec);
  jpeg_set_quality(&codec, 100, TRUE);
  for (int c = 0; c < codec.num_components; ++c) {
    codec.comp_info[c].h_samp_factor = 1;
    codec.comp_info[c].v_samp_factor = 1;
  }
  if (spec.components == 4) codec.write_Adobe_marker = spec.adobe_marker ? TRUE : FALSE;
  if (spec.progressive) jpeg_simple_progression(&codec);
  std::array<jpeg_scan_info, 4> scans{};
  for (std::size_t c = 0; c < scans.size(); ++c) scans[c] = {1, {static_cast<int>(c)}, 0, DCTSIZE2 - 1, 0, 0};
  if (spec.separate_scans) {
    codec.scan_info = scans.data();
    codec.num_scans = codec.num_components;
  }
  jpeg_start_compress(&codec, TRUE);
  Bytes copy = spec.samples;
  const std::size_t row_bytes = std::size_t{spec.width} * static_cast<std::size_t>(spec.components);
  while (codec.next_scanline < codec.image_height) {
    JSAMPROW row = copy.data() + codec.next_scanline * row_bytes;
    jpeg_write_scanlines(&codec, &row, 1);
  }
  jpeg_finish_compress(&codec);
  jpeg_destroy_compress(&codec);
  Bytes bytes(data, data + size);
  std::free(data);
  return bytes;
}

Bytes gradient_rgb(std::uint32_t width, std::uint32_t height) {
  Bytes samples;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      samples.push_back(static_cast<std::uint8_t>(x * 255 / width));
      samples.push_back(static_cast<std::uint8_t>(y * 255 / height));
      samples.push_back(static_cast<std::uint8_t>((x * 3 + y * 5) % 256));
    }
  }
  return samples;
}

}  // namespace hemiray::test
