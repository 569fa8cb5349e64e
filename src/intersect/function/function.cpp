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

/// Number of operations up to which the compiled function is optimised: 20,000 take clang more than a minute.
constexpr std::size_t most_optimised = 4000;

/// Parts of `FILE:NAME` or `FILE:NAME:WORDS`.
struct Named {
    fs::path file;
    std::string function, words;
};

Named split(const std::string& named) {
    const auto fail = [&named](const std::string& what) {
        throw InputError("--function " + named + ": " + what +
                         "; write FILE.c:NAME (also .cpp, .cc, .cxx, .rs, .glsl, .hlsl, .spv, .ll, .bc)");
    };
    std::error_code none;
    for (std::size_t end = named.find(':'); end != std::string::npos; end = named.find(':', end + 1)) {
        if (!fs::is_regular_file(named.substr(0, end), none)) continue;
        Named made{named.substr(0, end), {}, {}};
        const std::string rest = named.substr(end + 1);
        std::size_t colon = 0;  // one that is not a part of ::
        for (; colon < rest.size(); ++colon) {
            if (rest[colon] != ':') continue;
            if (colon + 1 < rest.size() && rest[colon + 1] == ':') ++colon;
            else break;
        }
        made.function = rest.substr(0, colon);
        if (colon < rest.size()) made.words = rest.substr(colon + 1);
        if (made.function.empty()) fail("names no function");
        return made;
    }
    if (fs::exists(named, none)) fail("names no function");
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

/// Writes a file that makes the compiler keep the function, so that its types can be read. An empty name keeps none.
std::string probe_of(SourceLanguage language, const fs::path& file, const std::string& name) {
    const bool is_rust = language == SourceLanguage::rust;
    const std::string include = is_rust ? text_of(file) + "\n" : "#include \"" + file.string() + "\"\n";
    if (name.empty()) return include;
    if (is_rust)
        return include + "#[no_mangle] pub fn lostbits_keep() -> usize { " + name + " as *const () as usize }\n";
    if (language == SourceLanguage::c) return include + "void* lostbits_keep(void) { return (void*)" + name + "; }\n";
    return include + "auto lostbits_keep = &" + name + ";\n";
}

/// LLVM IR of the probe. A name that is not in the file is refused with the functions that the file defines.
std::string probed_ir(Compiler& compiler, SourceLanguage language, const Named& parts, const std::string& source) {
    try {
        return compiler.ir(probe_of(language, compiler.file(), parts.function), false);
    } catch (const InputError&) {
        if (mentions(source, parts.function)) throw;
    }
    const std::string whole = compiler.ir(probe_of(language, compiler.file(), ""), false);
    throw InputError(no_function(whole, parts.file.string(), parts.function, language));
}

/// The decision that t means a miss, of numbers or of recorded operations.
template <class Decisions>
auto means_miss(const MissValue& s, const Decisions& d) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    switch (s.kind) {
        case MissValue::Kind::negative: return d.compare(TapeOp::less, d.t, d.number(0));
        case MissValue::Kind::infinite:
            return d.either(d.compare(TapeOp::greater_equal, d.t, d.number(infinity)),
                            d.compare(TapeOp::less_equal, d.t, d.number(-infinity)));
        case MissValue::Kind::nan: return d.opposite(d.compare(TapeOp::less_equal, d.t, d.t));
        case MissValue::Kind::zero: return d.compare(TapeOp::less_equal, d.t, d.number(0));
        case MissValue::Kind::above: return d.compare(TapeOp::greater_equal, d.t, d.number(s.bound));
        case MissValue::Kind::crossed:
            return d.either(d.compare(TapeOp::greater, d.t, d.far), d.compare(TapeOp::less, d.far, d.number(0)));
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
    [[nodiscard]] static bool either(bool a, bool b) { return a || b; }
    [[nodiscard]] static bool opposite(bool a) { return !a; }
    [[nodiscard]] static bool never() { return false; }
};

struct NodeDecisions {
    Nodes& nodes;
    NodeId t, far;
    [[nodiscard]] NodeId number(double x) const { return nodes.constant(x, false); }
    [[nodiscard]] Mask compare(TapeOp op, NodeId a, NodeId b) const { return nodes.compare(op, a, b); }
    [[nodiscard]] Mask either(Mask a, Mask b) const { return nodes.either(a, b); }
    [[nodiscard]] Mask opposite(Mask a) const { return nodes.opposite(a); }
    [[nodiscard]] static Mask never() { return no; }
};

/// Value that the function returns for a miss, guessed from the constants that its t may be.
MissValue guessed_sentinel(const Nodes& nodes, NodeId t, NodeId far) {
    bool others = false;
    const std::vector<double> constants = nodes.constants_of(t, others);
    if (constants.empty() && far != no_node) return {MissValue::Kind::crossed, 0};
    const auto any = [&](const auto& is) { return std::ranges::any_of(constants, is); };
    if (any([](double x) { return std::isnan(x); })) return {MissValue::Kind::nan, 0};
    if (any([](double x) { return std::isinf(x) && x > 0; })) return {MissValue::Kind::infinite, 0};
    for (const double x : constants)
        if (x >= 1e5) return {MissValue::Kind::above, x};
    if (!any([](double x) { return x < 0; }) && any([](double x) { return x == 0; })) return {MissValue::Kind::zero, 0};
    return {MissValue::Kind::negative, 0};
}

std::string sentinel_words(const MissValue& s) {
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

/// The compiled function.
template <class S>
void answer_batch(void (*entry)(const S*, S*, int*), const MissValue& sentinel, std::size_t numbers,
                  const lb_batch& batch) {
    const auto* const rays = static_cast<const S*>(batch.rays);
    const auto* const primitives = static_cast<const S*>(batch.primitives);
    const auto* const ends = static_cast<const S*>(batch.ends);
    auto* const near_far = static_cast<S*>(batch.near_far);
    for (std::size_t i = 0; i < batch.size; ++i) {
        std::array<S, 64> in{};
        std::copy_n(rays + 6 * i, 6, in.begin());
        std::copy_n(primitives + batch.primitive_stride * i, numbers, in.begin() + 6);
        in[6 + numbers] = ends != nullptr ? ends[i] : std::numeric_limits<S>::infinity();
        std::array<S, 2> out{};
        int hit = 0;
        entry(in.data(), out.data(), &hit);
        batch.hit[i] = hit != 0 && !means_miss(sentinel, NumberDecisions{out[0], out[1]}) ? 1 : 0;
        near_far[2 * i] = out[0], near_far[2 * i + 1] = out[1];
    }
}

/// Answer of a function as the table has it. `external::hit_of` does the same for compiled answers.
struct Outputs {
    Mask hit;
    NodeId t, near, far;
};

Outputs outputs_of(Nodes& nodes, const external::Contract& c, const Walk::Answer& answer, Mask hit) {
    const NodeId zero = nodes.constant(0, false);
    if (c.roots == Roots::none) return {hit, zero, zero, zero};
    const NodeId near = answer.t;
    if (c.roots == Roots::near_only)
        return {nodes.both(hit, nodes.opposite(nodes.compare(TapeOp::less, near, zero))), near, near, near};
    if (c.roots != Roots::both || answer.far == no_node) return {hit, near, near, near};
    const NodeId far = answer.far;
    const TapeOp ahead_op = c.at_origin == AtOrigin::hit ? TapeOp::greater_equal : TapeOp::greater;
    const Mask ahead = nodes.either(nodes.is_nan(near), nodes.compare(ahead_op, near, zero));
    const Inside inside = external::inside_of(c);
    const bool at_0 = inside == Inside::zero || (inside == Inside::usual && inside_returns_zero(c.shape));
    if (inside == Inside::miss) hit = nodes.both(hit, ahead);
    if (c.at_origin == AtOrigin::miss)
        hit = nodes.both(hit, nodes.opposite(nodes.compare(TapeOp::less_equal, far, zero)));
    if ((c.flags & LB_LINE) != 0) hit = nodes.both(hit, nodes.opposite(nodes.compare(TapeOp::less, far, zero)));
    return {hit, nodes.select(ahead, near, at_0 ? zero : far), near, far};
}

WrittenIn written_in(const fs::path& file, SourceLanguage language) {
    if (language == SourceLanguage::c) return WrittenIn::c;
    if (language == SourceLanguage::cpp) return WrittenIn::cpp;
    if (language == SourceLanguage::rust) return WrittenIn::rust;
    if (file.extension() == ".hlsl") return WrittenIn::hlsl;
    return is_shader(file) && file.extension() != ".spv" ? WrittenIn::glsl : WrittenIn::other;
}

/// The numbers of the arguments, and what the variables of the function receive.
std::vector<NamedNumber> names_of(const UserSignature& s, const Walk& walk, const std::vector<NodeId>& operation_of) {
    std::vector<NamedNumber> all;
    for (const InputSlot& in : s.inputs) {
        const std::size_t open = in.source.find("in[");
        if (open == std::string::npos || in.slot.argument < 0) continue;
        all.push_back({.text = text_of_part(s.arguments[static_cast<std::size_t>(in.slot.argument)], in.slot.at),
                       .operation = no_node,
                       .input = std::atoi(in.source.c_str() + open + 3),
                       .is_inverse = open > 0});
    }
    for (const Walk::Stored& v : walk.stored())
        if (const NodeId operation = operation_of[static_cast<std::size_t>(v.node)]; operation != no_node)
            all.push_back({.text = v.name, .operation = operation, .place = v.place, .declared = v.declared});
    return all;
}

/// Compares the operations that were read with the compiled function on random rays. InputError if they differ.
template <class S>
void require_same(const table::Kernel<S>& native, const table::Kernel<S>& written, Shape shape, bool tells_t,
                  const std::string& who) {
    const table::RandomRays<S> rays(shape, 4096, false);
    const table::RowAnswers<S> compiled = rays.answers(native), read = rays.answers(written);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (compiled.are_same(read, i, tells_t)) continue;
        std::ostringstream text;
        text << who << ": the operations that were read differ from the compiled function, on the ray ";
        text.precision(std::numeric_limits<S>::max_digits10);
        for (std::size_t k = 0; k < 6; ++k) text << (k == 0 ? "" : ",") << rays.input(i, k);
        text << " and the " << name_of(shape) << " ";
        for (std::size_t k = 0; k < rays.numbers(i).size(); ++k) text << (k == 0 ? "" : ",") << rays.numbers(i)[k];
        const auto said = [&](const table::RowAnswers<S>& answers) {
            if (answers.hit[i] == 0) text << "a miss";
            else text << "t = " << answers.numbers[0][i];
        };
        text << ": ";
        said(read);
        text << ", and compiled ";
        said(compiled);
        text << "; it may keep state between calls";
        throw InputError(text.str());
    }
}

std::string plain_name(const std::string& function) {
    std::string name;
    for (const char c : function) {
        const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
        if (plain) name += c;
        else if (!name.empty() && name.back() != '.') name += '.';
    }
    while (!name.empty() && name.back() == '.') name.pop_back();
    return "function." + name.substr(0, 50);
}

}  // namespace

std::unique_ptr<UserFunction> load_function(const std::string& named, const CompileTerms& terms) {
    const Named parts = split(named);
    const SourceLanguage language = language_of(parts.file, named);
    auto made = std::make_unique<UserFunction>();
    made->path = parts.file.string();
    made->name = named.substr(made->path.size());
    made->language = written_in(parts.file, language);
    Compiler compiler(parts.file, language, terms);
    const bool is_ir = language == SourceLanguage::llvm;
    const Compiler::FileText file = is_ir ? compiler.ir_of_file() : Compiler::FileText{{}, text_of(parts.file)};
    made->source = file.source;
    const std::string who = made->path + ":" + parts.function;

    Module probe(is_ir ? file.ir : probed_ir(compiler, language, parts, made->source));
    UserSignature signature = signature_of(probe, made->path, parts.function, language);
    guess(signature,
          parts.words.empty() ? stated_in(made->source, made->path, signature.line)
                              : stated_by(parts.words, "--function " + named),
          who);
    const std::string wrapper =
        is_ir ? ir_wrapper_of(signature, probe, who)
              : wrapper_of(signature, language == SourceLanguage::rust ? made->source : compiler.file().string());
    Module module(is_ir ? wrapper : compiler.ir(wrapper, true));
    Nodes nodes(signature.bits);
    Walk walk(module, nodes, signature.folder.empty() ? compiler.file().parent_path().string() : signature.folder,
              is_ir ? compiler.file().string() : "");
    const std::size_t numbers = row_of(signature.contract.shape).numbers;
    const Walk::Answer answer = walk.run("lostbits_entry", static_cast<int>(6 + numbers + 1));
    if (signature.t && answer.t == no_node) throw InputError(who + ": t is never written, or is undefined (as 3 / 0 is)");
    if (signature.sentinel.kind == MissValue::Kind::unknown)
        signature.sentinel = guessed_sentinel(nodes, answer.t, answer.far);
    if (const std::string words = sentinel_words(signature.sentinel); !words.empty())
        made->shown = who + ": " + signature.shown + "; " + words;
    else made->shown = who + ": " + signature.shown;

    made->bits = signature.bits, made->line = signature.line;
    external::Contract& contract = signature.contract;
    if (contract.name.empty()) contract.name = plain_name(parts.function);
    contract.source = parts.file.filename().string();
    if (contract.title.empty()) contract.title = parts.function + " of " + parts.file.filename().string();
    external::require_sense(contract, who);
    Mask hit = answer.hit;
    if (signature.sentinel.kind == MissValue::Kind::crossed && answer.far == no_node)
        throw InputError(who + ": miss is crossed, but it answers no far t");
    if (answer.t != no_node)
        hit =
            nodes.both(hit, nodes.opposite(means_miss(signature.sentinel, NodeDecisions{nodes, answer.t, answer.far})));
    const Outputs out = outputs_of(nodes, contract, answer, hit);
    // The answer itself may have no variable, so it is named here.
    if (out.t != no_node && contract.roots != Roots::none) nodes.name(out.t, "t", 100);
    Nodes::Written written = nodes.written(out.hit, out.t, out.near, out.far);
    written.formula.name = contract.name;
    written.formula.shape = contract.shape;
    table::require_sense(written.formula);
    made->names = names_of(signature, walk, written.operation_of);
    made->places = walk.places();
    for (SourcePlace& p : made->places)
        if (const fs::path relative = fs::path(p.file).lexically_normal(); relative == compiler.file())
            p.file = made->path;
    for (const int place : written.places) {
        const int own = walk.own_place(place);
        made->place_of_operation.push_back(own);
    }
    const auto formula = std::make_shared<const table::WrittenFormula>(std::move(written.formula));
    made->written = std::make_unique<table::WrittenForm>(formula, formula);

    const external::Library library = compiler.library(wrapper, formula->operations.size() > most_optimised);
    external::ForeignForm form{contract, made->path, {}};
    const char* const name = external::lasting_text(external::name_in_messages(form));
    const auto bind = [&]<class S>(S) {
        const auto entry = external::entry_of<void (*)(const S*, S*, int*)>(library, "lostbits_entry");
        if (entry == nullptr) throw InputError(who + ": the compiled function has no entry");
        form.answer = [entry, name, numbers, sentinel = signature.sentinel,
                       computes = library.fp_state](const lb_batch& batch) {
            external::call_of(name, [&] {
                const external::InForeignCode here(name, computes);
                answer_batch<S>(entry, sentinel, numbers, batch);
                return 0;
            });
        };
    };
    if (signature.bits == 32) bind(0.0F);
    else bind(0.0);
    made->answers = std::make_unique<external::ForeignRow>(std::move(form));
    made->answers->info.formats = Formats::all;
    made->row = made->answers->row();
    made->written->fill(made->row);
    const table::Intersector alone = made->written->row(made->answers->info);
    const bool tells_t = contract.roots != Roots::none;
    if (signature.bits == 32) {
        require_same(made->row.native32, alone.native32, contract.shape, tells_t, who);
        made->row.native64 = alone.native64;
    } else {
        require_same(made->row.native64, alone.native64, contract.shape, tells_t, who);
        made->row.native32 = alone.native32;
    }
    return made;
}

}  // namespace lostbits::intersect::function
