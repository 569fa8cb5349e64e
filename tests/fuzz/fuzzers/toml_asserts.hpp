// toml++ 3.3 asserts properties of the input that its next lines check and report; Debian's library is built without
// assertions.
#define TOML_ASSERT(condition) static_assert(true)
