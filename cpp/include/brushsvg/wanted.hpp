#pragma once

/// The name until 0.2: target_mark.hpp.
#include "brushsvg/target_mark.hpp"
