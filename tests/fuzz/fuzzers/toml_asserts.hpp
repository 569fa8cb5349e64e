// toml++ 3.3 asserts about input what it finds out, and reports, in its next lines; Debian's library is built without.
#define TOML_ASSERT(condition) static_assert(true)
