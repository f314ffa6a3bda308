#include <fstream> // which the header forgets where TINYGLTF_NO_FS is set

#define TINYGLTF_IMPLEMENTATION
#include "host/io/tinygltf.hpp"
