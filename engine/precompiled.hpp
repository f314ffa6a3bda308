// What most files of the engine include, compiled once; each file includes what it uses all the same.
#include <fmt/format.h>
#include <volk.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <tuple>
#include <vector>
