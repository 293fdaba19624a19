// PNG through libpng, JPEG through libjpeg-turbo. Both libraries report errors by longjmp: the functions that call
// setjmp hold trivially destructible locals only, and everything that owns memory lives in their callers.
#include "host/base/image_decode.hpp"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstring>

#include <jpeglib.h>  // needs <cstdio> before it

#include <jerror.h>
#include <png.h>

#include "host/base/error.hpp"

namespace hemiray {
namespace {

// No deflate stream grows more than this many times (zlib's documentation), so a header that claims more is cut short.
constexpr std::uint64_t kMaxDeflateRatio = 1032;
// A JPEG spends at least one Huffman bit on the DC value of each 8x8 block: 512 pixels a byte. Twice that for slack.
constexpr std::uint64_t kMaxJpegPixelsPerByte = 1024;
// Small, slow progressive files are made of thousands of scans; real ones have about ten.
constexpr int kMaxJpegScans = 100;
constexpr int kSetjmpError = 1;

void check_size(std::uint32_t width, std::uint32_t height, const std::string& place) {
  if (width == 0 || height == 0) throw InputError(place, "the image has no pixels");
  if (width > kMaxTextureSide || height > kMaxTextureSide ||
      std::uint64_t{width} * std::uint64_t{height} > kMaxTexturePixels) {
    throw InputError(place, "the image is " + std::to_string(width) + " x " + std::to_string(height) +
                                ", more than the limit of " + std::to_string(kMaxTextureSide) + " on a side and " +
                                std::to_string(kMaxTexturePixels >> 20U) + " Mpixel in all; scale it down");
  }
}

[[noreturn]] void throw_broken(const std::string& place, const char* format, const char* message) {
  throw InputError(place, std::string("broken or truncated ") + format + " image (" + message + "); save it again");
}

// ---- PNG ----

struct PngReader {
  png_structp png = nullptr;
  png_infop info = nullptr;
  const std::uint8_t* next = nullptr;
  std::size_t left = 0;
  std::array<char, 160> message{};

  explicit PngReader(std::span<const std::uint8_t> bytes) : next(bytes.data()), left(bytes.size()) {}
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

extern "C" void hemiray_png_read_error(png_structp png, png_const_charp text) {
  auto* reader = static_cast<PngReader*>(png_get_error_ptr(png));
  std::snprintf(reader->message.data(), reader->message.size(), "%s", text);
  png_longjmp(png, kSetjmpError);
}

extern "C" void hemiray_png_read_warning(png_structp /*png*/, png_const_charp /*text*/) {}

extern "C" void hemiray_png_read_bytes(png_structp png, png_bytep out, png_size_t count) {
  auto* reader = static_cast<PngReader*>(png_get_io_ptr(png));
  if (count > reader->left) png_error(png, "the data ends early");
  std::memcpy(out, reader->next, count);
  reader->next += count;
  reader->left -= count;
}

bool png_start(PngReader* reader) {
  if (setjmp(png_jmpbuf(reader->png))) return false;
  png_set_read_fn(reader->png, reader, hemiray_png_read_bytes);
  png_set_user_limits(reader->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // check_size gives the better message
  // Only pixels matter here: no colour profile or text is kept.
  png_set_keep_unknown_chunks(reader->png, PNG_HANDLE_CHUNK_NEVER, nullptr, 0);
  png_read_info(reader->png, reader->info);
  return true;
}

bool png_finish(PngReader* reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader->png))) return false;
  png_read_image(reader->png, rows);
  png_read_end(reader->png, nullptr);
  return true;
}

bool png_to_rgba8(PngReader* reader) {
  if (setjmp(png_jmpbuf(reader->png))) return false;
  png_set_expand(reader->png);  // palettes, less than 8 bits, transparent colours
  png_set_scale_16(reader->png);
  png_set_gray_to_rgb(reader->png);
  png_set_add_alpha(reader->png, 0xff, PNG_FILLER_AFTER);
  png_set_interlace_handling(reader->png);
  png_read_update_info(reader->png, reader->info);
  return true;
}

DecodedImage decode_png(std::span<const std::uint8_t> bytes, const std::string& place) {
  PngReader reader(bytes);
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, hemiray_png_read_error, hemiray_png_read_warning);
  if (reader.png != nullptr) reader.info = png_create_info_struct(reader.png);
  if (reader.info == nullptr) throw DeviceError(place + ": out of memory while reading a PNG image");

  if (!png_start(&reader)) throw_broken(place, "PNG", reader.message.data());
  const std::uint32_t width = png_get_image_width(reader.png, reader.info);
  const std::uint32_t height = png_get_image_height(reader.png, reader.info);
  check_size(width, height, place);
  const std::uint64_t stored_bytes = std::uint64_t{png_get_rowbytes(reader.png, reader.info)} * height;
  if (stored_bytes / kMaxDeflateRatio > bytes.size()) throw_broken(place, "PNG", "too little data for its size");

  if (!png_to_rgba8(&reader)) throw_broken(place, "PNG", reader.message.data());
  const std::size_t row_bytes = std::size_t{width} * 4;
  if (png_get_rowbytes(reader.png, reader.info) != row_bytes) throw_broken(place, "PNG", "unexpected row size");
  DecodedImage image{static_cast<int>(width), static_cast<int>(height), {}};
  image.rgba.resize(row_bytes * height);
  std::vector<png_bytep> rows(height);
  for (std::size_t y = 0; y < height; ++y) rows[y] = image.rgba.data() + y * row_bytes;
  if (!png_finish(&reader, rows.data())) throw_broken(place, "PNG", reader.message.data());
  return image;
}

// ---- JPEG ----

struct JpegReader {
  jpeg_decompress_struct codec{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf on_error{};
  std::array<char, JMSG_LENGTH_MAX> message{};
  bool created = false;

  JpegReader() = default;
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;
  ~JpegReader() {
    if (created) jpeg_destroy_decompress(&codec);
  }
};

extern "C" void hemiray_jpeg_error(j_common_ptr codec) {
  auto* reader = static_cast<JpegReader*>(codec->client_data);
  codec->err->format_message(codec, reader->message.data());
  std::longjmp(reader->on_error, kSetjmpError);
}

extern "C" void hemiray_jpeg_message(j_common_ptr codec, int level) {
  if (level >= 0) return;  // trace output
  const int code = codec->err->msg_code;
  // These leave the pixels whole; every other warning means that data is missing or was guessed.
  const bool harmless =
      code == JWRN_EXTRANEOUS_DATA || code == JWRN_ADOBE_XFORM || code == JWRN_JFIF_MAJOR || code == JWRN_TOO_MUCH_DATA;
  if (!harmless) hemiray_jpeg_error(codec);
}

extern "C" void hemiray_jpeg_silent(j_common_ptr /*codec*/) {}

extern "C" void hemiray_jpeg_progress(j_common_ptr codec) {
  auto* reader = static_cast<JpegReader*>(codec->client_data);
  if (reader->codec.input_scan_number <= kMaxJpegScans) return;
  std::snprintf(reader->message.data(), reader->message.size(), "more than %d scans", kMaxJpegScans);
  std::longjmp(reader->on_error, kSetjmpError);
}

bool jpeg_start(JpegReader* reader, const std::uint8_t* data, std::size_t size) {
  if (setjmp(reader->on_error)) return false;
  reader->codec.err = jpeg_std_error(&reader->errors);
  reader->errors.error_exit = hemiray_jpeg_error;
  reader->errors.emit_message = hemiray_jpeg_message;
  reader->errors.output_message = hemiray_jpeg_silent;
  reader->codec.client_data = reader;
  reader->created = true;  // before the call: what it allocated before an error is to be freed as well
  jpeg_create_decompress(&reader->codec);
  reader->progress.progress_monitor = hemiray_jpeg_progress;
  reader->codec.progress = &reader->progress;
  jpeg_mem_src(&reader->codec, data, static_cast<unsigned long>(size));
  jpeg_read_header(&reader->codec, TRUE);
  return true;
}

bool jpeg_finish(JpegReader* reader, std::uint8_t* rgba, J_COLOR_SPACE space) {
  if (setjmp(reader->on_error)) return false;
  jpeg_decompress_struct* codec = &reader->codec;
  codec->out_color_space = space;
  jpeg_start_decompress(codec);
  const std::size_t row_bytes = std::size_t{codec->output_width} * 4;
  while (codec->output_scanline < codec->output_height) {
    JSAMPROW row = rgba + codec->output_scanline * row_bytes;
    jpeg_read_scanlines(codec, &row, 1);
  }
  jpeg_finish_decompress(codec);
  return true;
}

// In place. Adobe's files hold the inverted inks, the others the inks themselves.
void cmyk_to_rgba(std::vector<std::uint8_t>& pixels, bool inverted) {
  for (std::size_t i = 0; i + 3 < pixels.size(); i += 4) {
    const unsigned k = inverted ? pixels[i + 3] : 255U - pixels[i + 3];
    for (std::size_t c = 0; c < 3; ++c) {
      const unsigned ink = inverted ? pixels[i + c] : 255U - pixels[i + c];
      pixels[i + c] = static_cast<std::uint8_t>((ink * k + 127U) / 255U);
    }
    pixels[i + 3] = 255;
  }
}

DecodedImage decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& place) {
  JpegReader reader;
  if (!jpeg_start(&reader, bytes.data(), bytes.size())) throw_broken(place, "JPEG", reader.message.data());
  const std::uint32_t width = reader.codec.image_width;
  const std::uint32_t height = reader.codec.image_height;
  check_size(width, height, place);
  const std::uint64_t pixels = std::uint64_t{width} * height;
  if (pixels / kMaxJpegPixelsPerByte > bytes.size()) throw_broken(place, "JPEG", "too little data for its size");

  const bool cmyk = reader.codec.jpeg_color_space == JCS_CMYK || reader.codec.jpeg_color_space == JCS_YCCK;
  DecodedImage image{static_cast<int>(width), static_cast<int>(height), {}};
  image.rgba.resize(pixels * 4);
  if (!jpeg_finish(&reader, image.rgba.data(), cmyk ? JCS_CMYK : JCS_EXT_RGBA)) {
    throw_broken(place, "JPEG", reader.message.data());
  }
  if (cmyk) cmyk_to_rgba(image.rgba, reader.codec.saw_Adobe_marker != FALSE);
  return image;
}

}  // namespace

DecodedImage decode_image(std::span<const std::uint8_t> bytes, const std::string& place) {
  constexpr std::array<std::uint8_t, 8> kPngMagic{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr std::array<std::uint8_t, 3> kJpegMagic{0xff, 0xd8, 0xff};
  const auto starts_with = [&](const auto& magic) {
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  if (starts_with(kPngMagic)) return decode_png(bytes, place);
  if (starts_with(kJpegMagic)) return decode_jpeg(bytes, place);
  if (bytes.empty()) throw InputError(place, "the image file is empty");
  throw InputError(place, "neither a PNG nor a JPEG image; convert it to one of the two");
}

}  // namespace hemiray
