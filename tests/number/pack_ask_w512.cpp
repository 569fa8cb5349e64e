#include "number/pack_ask.hpp"

namespace lostbits::test {
namespace {

struct Width : Registers<64> {};

}  // namespace

void ask_w512(const PackQuestion<float>& question) { ask<Width>(question); }
void ask_w512(const PackQuestion<double>& question) { ask<Width>(question); }

}  // namespace lostbits::test
