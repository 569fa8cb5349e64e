// For builds of Catch2 2 without its Catch2WithMain library.
#define CATCH_CONFIG_MAIN
#include "catch.hpp"
