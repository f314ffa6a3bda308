// What nearly every file of the command line includes, compiled once.
#include "host/cli/commands.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
