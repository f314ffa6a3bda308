// Pictures as PNG, through libpng.
#pragma once

#include "host/image.hpp"
#include "host/io/atomic_file.hpp"

namespace cowgpu {

/// Writes 8 bits a channel, without alpha where the image is opaque, marked as sRGB; the caller commits the file. The same
/// image gives the same bytes with one version of libpng and zlib. Throws Error(bad_argument) for an image of no size or
/// of too few pixels, too_large, cannot_write.
void write_png(const Image& image, AtomicFile& file);

} // namespace cowgpu
