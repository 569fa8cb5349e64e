#include "number/pack_ask.hpp"

namespace lostbits::test {
namespace {

struct Width : Registers<16> {};

}  // namespace

void ask_w128(const PackQuestion<float>& question) { ask<Width>(question); }
void ask_w128(const PackQuestion<double>& question) { ask<Width>(question); }

}  // namespace lostbits::test
