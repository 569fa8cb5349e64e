#include "number/pack_ask.hpp"

namespace lostbits::test {
namespace {

struct Width : Registers<32> {};

}  // namespace

void ask_w256(const PackQuestion<float>& question) { ask<Width>(question); }
void ask_w256(const PackQuestion<double>& question) { ask<Width>(question); }

}  // namespace lostbits::test
