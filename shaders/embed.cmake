# Writes a SPIR-V module as a C++ array: -D NAME -D SPV -D HEADER -D SOURCE.
file(READ ${SPV} hex HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${hex}")
string(REGEX REPLACE "((0x........,){12})" "\\1\n" words "${words}")
file(WRITE ${HEADER} "#pragma once
#include <cstdint>
#include <span>
namespace cowgpu::shaders {
extern const std::span<const std::uint32_t> ${NAME};
}
")
file(WRITE ${SOURCE} "#include \"shaders/${NAME}.hpp\"
namespace cowgpu::shaders {
static constexpr std::uint32_t words[] = {
${words}};
const std::span<const std::uint32_t> ${NAME}(words);
} // namespace cowgpu::shaders
")
