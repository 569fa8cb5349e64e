// Functions of users: LLVM IR as text, and SPIR-V as words or as the text of spirv-dis.
#include <cstring>

#include "fuzz/fuzz.hpp"
#include "intersect/function/signature.hpp"
#include "intersect/function/walk.hpp"
#include "intersect/spirv/llvm_text.hpp"
#ifdef LOSTBITS_SPIRV_TOOLS
#include "spirv-tools/libspirv.h"
#endif

namespace lostbits::fuzz {
namespace {

using namespace intersect::function;

/// Follows a function of this name: its signature, the function that calls it, and its operations.
void follow(const std::string& ir, const std::string& name) {
    Module probe(ir);
    UserSignature signature = read_signature(probe, "own.ll", name, SourceLanguage::llvm);
    guess_signature(signature, {}, "own.ll");
    Module module(write_ir_wrapper(signature, probe, "own.ll"));
    Nodes nodes(signature.bits);
    const std::size_t number_count = row_of(signature.contract.shape).number_count;
    Walk walk(module, nodes, "/x", "own.ll");
    const auto answer = walk.run("lostbits_entry", static_cast<int>(6 + number_count + 1));
    if (answer.t != no_node) static_cast<void>(nodes.to_formula(answer.hit, answer.t, answer.t, answer.t));
}

/// The text of a module of SPIR-V; other bytes are taken as a text.
std::string assembly_of(std::string_view bytes) {
#ifdef LOSTBITS_SPIRV_TOOLS
    constexpr std::uint32_t magic = 0x07230203;
    std::vector<std::uint32_t> words(bytes.size() / 4);
    if (!words.empty()) std::memcpy(words.data(), bytes.data(), 4 * words.size());
    if (!words.empty() && words[0] == magic) {
        const spv_context context = spvContextCreate(SPV_ENV_VULKAN_1_1);
        spv_text text = nullptr;
        const auto options = SPV_BINARY_TO_TEXT_OPTION_NO_HEADER | SPV_BINARY_TO_TEXT_OPTION_FRIENDLY_NAMES;
        spvBinaryToText(context, words.data(), words.size(), options, &text, nullptr);
        const std::string assembly = text == nullptr ? "" : std::string(text->str, text->length);
        spvTextDestroy(text);
        spvContextDestroy(context);
        return assembly;
    }
#endif
    return std::string(bytes);
}

}  // namespace

void fuzz_llvm(std::string_view bytes) {
    const std::string text(bytes);
    answer_or_error([&] {
        Module module(text);
        Nodes nodes(32);
        Walk(module, nodes, "/x").run("lostbits_entry", 11);
    });
    answer_or_error([&] { follow(text, "ball"); });
}

void fuzz_spirv(std::string_view bytes) {
    answer_or_error([&] {
        const std::string assembly = assembly_of(bytes);
        static_cast<void>(intersect::spirv::source_file_name(assembly));
        follow(intersect::spirv::translate_to_llvm(assembly, "/x/own.spv", {}, true), "ball");
    });
}

}  // namespace lostbits::fuzz
