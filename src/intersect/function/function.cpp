#include "intersect/function/function.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <limits>
#include <sstream>

#include "intersect/external/guard.hpp"
#include "intersect/external/pipe_header.hpp"
#include "intersect/external/plugin.hpp"
#include "intersect/function/compiler.hpp"
#include "intersect/function/signature.hpp"
#include "intersect/function/walk.hpp"
#include "intersect/table/random_rays.hpp"
#include "number/error.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::intersect::function {

namespace {

/// A function with more operations than this is compiled without optimisation: clang takes more than a minute for
/// 20,000 operations.
constexpr std::size_t max_optimised_operations = 4000;

/// Parts of the option `FILE:NAME` or `FILE:NAME:SIGNATURE`.
struct OptionParts {
    fs::path file;
    std::string function, signature;
};

OptionParts split_option(const std::string& option) {
    const auto fail = [&option](const std::string& problem) {
        throw InputError("--function " + option + ": " + problem +
                         "; write FILE.c:NAME (also .cpp, .cc, .cxx, .rs, .glsl, .hlsl, .spv, .ll, .bc)");
    };
    std::error_code error;
    for (std::size_t end = option.find(':'); end != std::string::npos; end = option.find(':', end + 1)) {
        if (!fs::is_regular_file(option.substr(0, end), error)) continue;
        OptionParts parts{option.substr(0, end), {}, {}};
        const std::string rest = option.substr(end + 1);

        // The signature stands after a colon that is not a part of `::`.
        std::size_t colon = 0;
        for (; colon < rest.size(); ++colon) {
            if (rest[colon] != ':') continue;
            if (colon + 1 < rest.size() && rest[colon + 1] == ':') ++colon;
            else break;
        }
        parts.function = rest.substr(0, colon);
        if (colon < rest.size()) parts.signature = rest.substr(colon + 1);
        if (parts.function.empty()) fail("names no function");
        return parts;
    }
    if (fs::exists(option, error)) fail("names no function");
    fail("no such file");
    return {};
}

SourceLanguage language_of(const fs::path& file, const std::string& named) {
    const std::string ending = file.extension().string();
    if (ending == ".c") return SourceLanguage::c;
    for (const char* const cpp : {".cpp", ".cc", ".cxx", ".C", ".hpp", ".h", ".cppm", ".hh"})
        if (ending == cpp) return SourceLanguage::cpp;
    if (ending == ".rs") return SourceLanguage::rust;
    if (ending == ".ll" || ending == ".bc" || is_shader(file)) return SourceLanguage::llvm;
    throw InputError("--function " + named +
                     ": is not a file of C (.c), C++ (.cpp, .cc, .cxx, .h, .hpp), Rust (.rs), GLSL (.glsl, .frag, "
                     ".vert, .comp), HLSL (.hlsl), SPIR-V (.spv) or LLVM IR (.ll, .bc)");
}

/// Text of a file that makes the compiler keep the function, so that its types can be read. An empty name keeps no
/// function.
std::string probe_of(SourceLanguage language, const fs::path& file, const std::string& name) {
    const bool is_rust = language == SourceLanguage::rust;
    const std::string include = is_rust ? read_file(file) + "\n" : "#include \"" + file.string() + "\"\n";
    if (name.empty()) return include;
    if (is_rust)
        return include + "#[no_mangle] pub fn lostbits_keep() -> usize { " + name + " as *const () as usize }\n";
    if (language == SourceLanguage::c) return include + "void* lostbits_keep(void) { return (void*)" + name + "; }\n";
    return include + "auto lostbits_keep = &" + name + ";\n";
}

/// Returns the LLVM IR of the probe. Throws InputError with the list of the functions that the file defines if the name
/// is not in the file.
std::string probed_ir(Compiler& compiler, SourceLanguage language, const OptionParts& parts,
                      const std::string& source) {
    try {
        return compiler.compile_to_ir(probe_of(language, compiler.file(), parts.function), Compiler::Optimisation::off);
    } catch (const InputError&) {
        if (contains_word(source, parts.function)) throw;
    }
    const std::string ir_without_name =
        compiler.compile_to_ir(probe_of(language, compiler.file(), ""), Compiler::Optimisation::off);
    throw InputError(describe_missing_function(ir_without_name, parts.file.string(), parts.function, language));
}

/// Returns the decision whether t means a miss. `NumberDecisions` decides on numbers; `NodeDecisions` records the
/// operations of the decision.
template <class Decisions>
auto means_miss(const MissValue& miss_value, const Decisions& d) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    switch (miss_value.kind) {
        case MissValue::Kind::negative: return d.compare(TapeOp::less, d.t, d.number(0));
        case MissValue::Kind::infinite:
            return d.logical_or(d.compare(TapeOp::greater_equal, d.t, d.number(infinity)),
                                d.compare(TapeOp::less_equal, d.t, d.number(-infinity)));
        case MissValue::Kind::nan: return d.logical_not(d.compare(TapeOp::less_equal, d.t, d.t));
        case MissValue::Kind::zero: return d.compare(TapeOp::less_equal, d.t, d.number(0));
        case MissValue::Kind::above: return d.compare(TapeOp::greater_equal, d.t, d.number(miss_value.bound));
        case MissValue::Kind::crossed:
            return d.logical_or(d.compare(TapeOp::greater, d.t, d.far), d.compare(TapeOp::less, d.far, d.number(0)));
        default: return d.never();
    }
}

struct NumberDecisions {
    double t, far;
    [[nodiscard]] static double number(double x) { return x; }
    [[nodiscard]] static bool compare(TapeOp op, double a, double b) {
        switch (op) {
            case TapeOp::less: return a < b;
            case TapeOp::less_equal: return a <= b;
            case TapeOp::greater: return a > b;
            default: return a >= b;
        }
    }
    [[nodiscard]] static bool logical_or(bool a, bool b) { return a || b; }
    [[nodiscard]] static bool logical_not(bool a) { return !a; }
    [[nodiscard]] static bool never() { return false; }
};

struct NodeDecisions {
    Nodes& nodes;
    NodeId t, far;
    [[nodiscard]] NodeId number(double x) const { return nodes.constant(x, false); }
    [[nodiscard]] Mask compare(TapeOp op, NodeId a, NodeId b) const { return nodes.compare(op, a, b); }
    [[nodiscard]] Mask logical_or(Mask a, Mask b) const { return nodes.logical_or(a, b); }
    [[nodiscard]] Mask logical_not(Mask a) const { return nodes.logical_not(a); }
    [[nodiscard]] static Mask never() { return no; }
};

/// Guesses the value that the function returns for a miss from the constants that its t may have.
MissValue guess_miss_value(const Nodes& nodes, NodeId t, NodeId far) {
    bool has_others = false;
    const std::vector<double> constants = nodes.constants_of(t, has_others);
    if (constants.empty() && far != no_node) return {MissValue::Kind::crossed, 0};
    const auto any = [&](const auto& predicate) { return std::ranges::any_of(constants, predicate); };
    if (any([](double x) { return std::isnan(x); })) return {MissValue::Kind::nan, 0};
    if (any([](double x) { return std::isinf(x) && x > 0; })) return {MissValue::Kind::infinite, 0};
    for (const double x : constants)
        if (x >= 1e5) return {MissValue::Kind::above, x};
    if (!any([](double x) { return x < 0; }) && any([](double x) { return x == 0; })) return {MissValue::Kind::zero, 0};
    return {MissValue::Kind::negative, 0};
}

std::string miss_value_text(const MissValue& s) {
    switch (s.kind) {
        case MissValue::Kind::negative: return "hit where t is not negative";
        case MissValue::Kind::infinite: return "hit where t is not infinite";
        case MissValue::Kind::nan: return "hit where t is a number";
        case MissValue::Kind::zero: return "hit where t is not 0";
        case MissValue::Kind::above: {
            std::ostringstream text;
            text << "hit where t < " << s.bound;
            return text.str();
        }
        case MissValue::Kind::crossed: return "hit where t <= far and far is not negative";
        default: return "";
    }
}

/// Answers a batch with the compiled function.
template <class S>
void answer_batch(void (*entry)(const S*, S*, int*), const MissValue& miss_value, std::size_t number_count,
                  const lb_batch& batch) {
    const auto* const rays = static_cast<const S*>(batch.rays);
    const auto* const primitives = static_cast<const S*>(batch.primitives);
    const auto* const ends = static_cast<const S*>(batch.ends);
    auto* const near_far = static_cast<S*>(batch.near_far);
    for (std::size_t i = 0; i < batch.size; ++i) {
        std::array<S, 64> in{};
        std::copy_n(rays + 6 * i, 6, in.begin());
        std::copy_n(primitives + batch.primitive_stride * i, number_count, in.begin() + 6);
        in[6 + number_count] = ends != nullptr ? ends[i] : std::numeric_limits<S>::infinity();
        std::array<S, 2> out{};
        int hit = 0;
        entry(in.data(), out.data(), &hit);
        batch.hit[i] = hit != 0 && !means_miss(miss_value, NumberDecisions{out[0], out[1]}) ? 1 : 0;
        near_far[2 * i] = out[0];
        near_far[2 * i + 1] = out[1];
    }
}

/// The answer of a recorded function, in the fields that the table stores. `external::apply_contract` computes the same
/// fields for the compiled function.
struct Outputs {
    Mask hit;
    NodeId t, near, far;
};

Outputs outputs_of(Nodes& nodes, const external::Contract& contract, const Walk::Answer& answer, Mask hit) {
    // Functions without roots, or with one root.
    const NodeId zero = nodes.constant(0, false);
    if (contract.roots == Roots::none) return {hit, zero, zero, zero};
    const NodeId near = answer.t;
    if (contract.roots == Roots::near_only)
        return {nodes.logical_and(hit, nodes.logical_not(nodes.compare(TapeOp::less, near, zero))), near, near, near};
    if (contract.roots != Roots::both || answer.far == no_node) return {hit, near, near, near};

    const NodeId far = answer.far;
    const TapeOp ahead_comparison = contract.at_origin == AtOrigin::hit ? TapeOp::greater_equal : TapeOp::greater;
    const Mask near_is_ahead = nodes.logical_or(nodes.is_nan(near), nodes.compare(ahead_comparison, near, zero));
    const Inside inside = external::inside_of(contract);
    const bool inside_gives_zero =
        inside == Inside::zero || (inside == Inside::usual && inside_returns_zero(contract.shape));

    // The properties of the contract that make a hit a miss.
    if (inside == Inside::miss) hit = nodes.logical_and(hit, near_is_ahead);
    if (contract.at_origin == AtOrigin::miss)
        hit = nodes.logical_and(hit, nodes.logical_not(nodes.compare(TapeOp::less_equal, far, zero)));
    if ((contract.flags & LB_LINE) != 0)
        hit = nodes.logical_and(hit, nodes.logical_not(nodes.compare(TapeOp::less, far, zero)));
    return {hit, nodes.select(near_is_ahead, near, inside_gives_zero ? zero : far), near, far};
}

FileLanguage file_language_of(const fs::path& file, SourceLanguage language) {
    if (language == SourceLanguage::c) return FileLanguage::c;
    if (language == SourceLanguage::cpp) return FileLanguage::cpp;
    if (language == SourceLanguage::rust) return FileLanguage::rust;
    if (file.extension() == ".hlsl") return FileLanguage::hlsl;
    return is_shader(file) && file.extension() != ".spv" ? FileLanguage::glsl : FileLanguage::other;
}

/// Returns the names of the numbers in the arguments, then the names of the values that the function's variables
/// receive.
std::vector<NamedNumber> names_of(const UserSignature& signature, const Walk& walk,
                                  const std::vector<NodeId>& operation_of) {
    std::vector<NamedNumber> names;
    for (const InputSlot& input_slot : signature.inputs) {
        const std::size_t bracket = input_slot.source.find("in[");
        if (bracket == std::string::npos || input_slot.slot.argument < 0) continue;
        names.push_back({.text = part_text(signature.arguments[input_slot.slot.argument], input_slot.slot.offset),
                         .operation = no_node,
                         .input = std::atoi(input_slot.source.c_str() + bracket + 3),
                         .is_inverse = bracket > 0});
    }
    for (const Walk::StoredNumber& stored : walk.stored())
        if (const NodeId operation = operation_of[stored.node]; operation != no_node)
            names.push_back({.text = stored.name,
                             .operation = operation,
                             .place = stored.place,
                             .declaration_line = stored.declaration_line});
    return names;
}

/// Describes a ray on which the recorded operations and the compiled function differ.
template <class S>
std::string difference_text(const table::RandomRays<S>& rays, std::size_t i, Shape shape,
                            const table::FormAnswers<S>& recorded, const table::FormAnswers<S>& compiled) {
    std::ostringstream text;
    text << "the recorded operations and the compiled function give different answers on the ray ";
    text.precision(std::numeric_limits<S>::max_digits10);
    for (std::size_t k = 0; k < 6; ++k) text << (k == 0 ? "" : ",") << rays.input(i, k);
    text << " and the " << name_of(shape) << " ";
    for (std::size_t k = 0; k < rays.numbers(i).size(); ++k) text << (k == 0 ? "" : ",") << rays.numbers(i)[k];

    const auto append_answer = [&](const table::FormAnswers<S>& answers) {
        if (answers.hit[i] == 0) text << "a miss";
        else text << "t = " << answers.t[i];
    };
    text << ": recorded ";
    append_answer(recorded);
    text << ", compiled ";
    append_answer(compiled);
    text << "; does the function keep state between calls?";
    return text.str();
}

/// Compares the recorded operations with the compiled function on random rays. Throws InputError if they differ.
template <class S>
void require_same_answers(const table::Kernel<S>& native, const table::Kernel<S>& recorded, Shape shape, bool has_t,
                          const std::string& subject) {
    const table::RandomRays<S> rays(shape, 4096, false);
    const table::FormAnswers<S> compiled_answers = rays.answers(native), recorded_answers = rays.answers(recorded);
    for (std::size_t i = 0; i < rays.size(); ++i)
        if (!compiled_answers.are_same(recorded_answers, i, has_t))
            throw InputError(subject + ": " + difference_text(rays, i, shape, recorded_answers, compiled_answers));
}

/// Returns `function.NAME`, with the characters that a name of a form must not have replaced by dots.
std::string default_form_name(const std::string& function) {
    std::string name;
    for (const char c : function) {
        const bool is_allowed = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
        if (is_allowed) name += c;
        else if (!name.empty() && name.back() != '.') name += '.';
    }
    while (!name.empty() && name.back() == '.') name.pop_back();
    return "function." + name.substr(0, 50);
}

/// Sets the names of the contract that the user does not state.
void complete_contract(external::Contract& contract, const OptionParts& parts, const std::string& subject) {
    if (contract.name.empty()) contract.name = default_form_name(parts.function);
    contract.source = parts.file.filename().string();
    if (contract.title.empty()) contract.title = parts.function + " of " + parts.file.filename().string();
    external::require_valid(contract, subject);
}

/// Completes the recorded operations by the decision of a miss, and returns them as a formula with the contract's
/// fields.
Nodes::FormulaWithPlaces finish_recording(Nodes& nodes, const Walk::Answer& answer, const UserSignature& signature,
                                          const std::string& subject) {
    const external::Contract& contract = signature.contract;
    Mask hit = answer.hit;
    if (signature.miss_value.kind == MissValue::Kind::crossed && answer.far == no_node)
        throw InputError(
            subject + ": miss = crossed compares near with far, but the function returns no far t; state another miss");
    if (answer.t != no_node)
        hit = nodes.logical_and(
            hit, nodes.logical_not(means_miss(signature.miss_value, NodeDecisions{nodes, answer.t, answer.far})));
    const Outputs outputs = outputs_of(nodes, contract, answer, hit);

    // The answer itself may have no variable, so it is named here.
    if (outputs.t != no_node && contract.roots != Roots::none) nodes.name_node(outputs.t, "t", 100);
    Nodes::FormulaWithPlaces recorded = nodes.to_formula(outputs.hit, outputs.t, outputs.near, outputs.far);
    recorded.formula.name = contract.name;
    recorded.formula.shape = contract.shape;
    table::require_valid(recorded.formula);
    return recorded;
}

/// Makes the row that runs the compiled function.
template <class S>
external::ForeignForm compiled_form(const external::Library& library, const UserSignature& signature,
                                    const std::string& path, const std::string& subject) {
    external::ForeignForm form{signature.contract, path, {}};
    const char* const name = external::never_freed_copy(external::name_in_messages(form));
    const auto entry = external::find_symbol<void (*)(const S*, S*, int*)>(library, "lostbits_entry");
    if (entry == nullptr) throw InputError(subject + ": the compiled function has no entry");
    form.answer = [entry, name, number_count = row_of(signature.contract.shape).number_count,
                   miss_value = signature.miss_value, fp_state = library.fp_state](const lb_batch& batch) {
        external::call_foreign(name, [&] {
            const external::ForeignCodeScope foreign_code(name, fp_state);
            answer_batch<S>(entry, miss_value, number_count, batch);
            return 0;
        });
    };
    return form;
}

}  // namespace

std::unique_ptr<UserFunction> load_function(const std::string& option, const CompileSettings& settings) {
    const OptionParts parts = split_option(option);
    const SourceLanguage language = language_of(parts.file, option);
    auto user_function = std::make_unique<UserFunction>();
    user_function->path = parts.file.string();
    user_function->option_suffix = option.substr(user_function->path.size());
    user_function->language = file_language_of(parts.file, language);
    Compiler compiler(parts.file, language, settings);
    const bool is_ir = language == SourceLanguage::llvm;
    const Compiler::FileText file =
        is_ir ? compiler.read_ir_or_compile() : Compiler::FileText{{}, read_file(parts.file)};
    user_function->source = file.source;
    const std::string subject = user_function->path + ":" + parts.function;

    // Finds out which argument is what.
    Module probe(is_ir ? file.ir : probed_ir(compiler, language, parts, user_function->source));
    UserSignature signature = read_signature(probe, user_function->path, parts.function, language);
    guess_signature(signature,
                    parts.signature.empty()
                        ? read_signature_in_comments(user_function->source, user_function->path, signature.line)
                        : stated_signature(parts.signature, "--function " + option),
                    subject);

    // Records the operations of the function.
    const std::string wrapper =
        is_ir ? write_ir_wrapper(signature, probe, subject)
              : write_wrapper(signature,
                              language == SourceLanguage::rust ? user_function->source : compiler.file().string());
    Module module(is_ir ? wrapper : compiler.compile_to_ir(wrapper, Compiler::Optimisation::on));
    Nodes nodes(signature.bits);
    Walk walk(module, nodes, signature.folder.empty() ? compiler.file().parent_path().string() : signature.folder,
              is_ir ? compiler.file().string() : "");
    const std::size_t number_count = row_of(signature.contract.shape).number_count;
    const Walk::Answer answer = walk.run("lostbits_entry", static_cast<int>(6 + number_count + 1));
    if (signature.t && answer.t == no_node)
        throw InputError(subject + ": t is never written, or is undefined (as 3 / 0 is)");
    if (signature.miss_value.kind == MissValue::Kind::unknown)
        signature.miss_value = guess_miss_value(nodes, answer.t, answer.far);

    const std::string miss_text = miss_value_text(signature.miss_value);
    user_function->signature_text = subject + ": " + signature.text + (miss_text.empty() ? "" : "; " + miss_text);
    user_function->bits = signature.bits;
    user_function->line = signature.line;
    complete_contract(signature.contract, parts, subject);
    Nodes::FormulaWithPlaces recorded = finish_recording(nodes, answer, signature, subject);

    // The names and places of the operations. A path to the file itself becomes the path that the user wrote.
    user_function->names = names_of(signature, walk, recorded.operation_of);
    user_function->places = walk.places();
    for (SourcePlace& place : user_function->places)
        if (const fs::path normal_path = fs::path(place.file).lexically_normal(); normal_path == compiler.file())
            place.file = user_function->path;
    for (const int place : recorded.places)
        user_function->place_of_operation.push_back(walk.innermost_user_place(place));
    const auto formula = std::make_shared<const table::WrittenFormula>(std::move(recorded.formula));
    user_function->written = std::make_unique<table::WrittenForm>(formula, formula);

    // Compiles the function for its answers, and compares them with those of the recorded operations.
    const external::Library library = compiler.compile_library(
        wrapper, formula->operations.size() > max_optimised_operations ? Compiler::Optimisation::off
                                                                       : Compiler::Optimisation::on);
    user_function->answers = std::make_unique<external::ForeignIntersector>(
        signature.bits == 32 ? compiled_form<float>(library, signature, user_function->path, subject)
                             : compiled_form<double>(library, signature, user_function->path, subject));
    user_function->answers->info.formats = Formats::all;
    user_function->intersector = user_function->answers->to_intersector();
    user_function->written->fill(user_function->intersector);
    const table::Intersector recorded_form = user_function->written->make_intersector(user_function->answers->info);
    const external::Contract& contract = signature.contract;
    const bool has_t = contract.roots != Roots::none;
    if (signature.bits == 32) {
        require_same_answers(user_function->intersector.native32, recorded_form.native32, contract.shape, has_t,
                             subject);
        user_function->intersector.native64 = recorded_form.native64;
    } else {
        require_same_answers(user_function->intersector.native64, recorded_form.native64, contract.shape, has_t,
                             subject);
        user_function->intersector.native32 = recorded_form.native32;
    }
    return user_function;
}

}  // namespace lostbits::intersect::function
