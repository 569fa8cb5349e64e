// Precompiled headers: those that most files of the libraries include and that rarely change. A file must still include
// what it uses; the preset `dev` compiles without this header and finds files that do not.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "geometry/vec.hpp"
#include "number/interval.hpp"
#include "number/real.hpp"
