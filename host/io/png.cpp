#include "host/io/png.hpp"

#include "host/error.hpp"

#include <fmt/format.h>
#include <png.h>

#include <cstring>

namespace cowgpu {

void write_png(const Image& image, AtomicFile& file) {
  const std::size_t pixels = std::size_t(std::max(image.width, 0)) * std::size_t(std::max(image.height, 0));
  if (pixels == 0 || image.rgba.size() != 4 * pixels)
    throw Error(Fault::bad_argument, fmt::format("an image of {} x {} pixels with {} bytes cannot be written",
                                                 image.width, image.height, image.rgba.size()));
  std::vector<std::uint8_t> rgb;
  if (image.opaque) {
    rgb.resize(3 * pixels);
    for (std::size_t i = 0; i < pixels; ++i) std::memcpy(&rgb[3 * i], &image.rgba[4 * i], 3);
  }
  png_image png;
  std::memset(&png, 0, sizeof png);
  png.version = PNG_IMAGE_VERSION;
  png.width = png_uint_32(image.width);
  png.height = png_uint_32(image.height);
  png.format = image.opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  const void* const from = image.opaque ? rgb.data() : image.rgba.data();
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(png), '\0');
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, from, 0, nullptr))
    throw Error(Fault::too_large,
                fmt::format("a PNG file of {} x {} pixels cannot be made: {}", image.width, image.height, png.message));
  file.write(std::string_view(bytes).substr(0, size));
}

} // namespace cowgpu
