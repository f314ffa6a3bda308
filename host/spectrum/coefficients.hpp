// Moved.
#pragma once
#include "host/coefficients.hpp"
