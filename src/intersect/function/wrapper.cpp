// The file that calls a user's function with the numbers of a ray and a primitive. The compiler then follows the
// calling convention: structures in registers, references, results in memory.
#include <algorithm>

#include "intersect/function/signature.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

using Kind = SourceType::Kind;

std::string buffer(int argument) { return "lb_p" + std::to_string(argument); }

std::string number_name(std::size_t size, SourceLanguage language) {
    if (language == SourceLanguage::rust) return size == 4 ? "f32" : "f64";
    return size == 4 ? "float" : "double";
}

/// `*(T*)lb_p0`, or the pointer.
std::string c_argument(const Argument& a, int k) {
    const bool points = a.type.kind == Kind::pointer;
    const SourceType& t = a.target();
    std::string cast = t.kind == Kind::nothing ? "void*" : t.name + "*";
    if (t.kind == Kind::sequence) cast = t.parts[0].name + "(*)[" + std::to_string(t.count) + "]";
    const std::string pointer = "(" + cast + ")" + buffer(k);
    if (points && a.type.name != "&") return pointer;
    return "*(" + pointer + ")";
}

/// `lb_in[3]`, `1 / lb_in[3]` or `0`.
std::string c_source(std::string source) {
    if (const std::size_t at = source.find("in["); at != std::string::npos) source.insert(at, "lb_");
    return source;
}

std::string c_wrapper(const UserSignature& s, const std::string& path) {
    const bool cpp = s.language == SourceLanguage::cpp;
    const std::string number = number_name(static_cast<std::size_t>(s.bits) / 8, s.language);
    std::string text = "#include \"" + path + "\"\n" + (cpp ? "extern \"C\" " : "") + "void lostbits_entry(const " +
                       number + "* lb_in, " + number + "* lb_out, int* lb_hit) {\n";
    for (std::size_t k = 0; k < s.arguments.size(); ++k) {
        const std::size_t size = std::max<std::size_t>(s.arguments[k].target().size, 64);
        text += "    " + std::string(cpp ? "alignas(64)" : "_Alignas(64)") + " unsigned char " +
                buffer(static_cast<int>(k)) + "[" + std::to_string(size) + "] = {0};\n";
    }
    for (const InputSlot& in : s.inputs)
        text += "    { " + number_name(in.slot.size, s.language) + " lb_v = " + c_source(in.source) +
                "; __builtin_memcpy(" + buffer(in.slot.argument) + " + " + std::to_string(in.slot.at) +
                ", &lb_v, sizeof lb_v); }\n";
    std::string call = s.call;
    std::size_t first = 0;
    if (s.is_method) {
        const std::size_t colon = call.rfind("::");
        call = "((" + call.substr(0, colon) + "*)" + buffer(0) + ")->" + call.substr(colon + 2);
        first = 1;
    }
    call += "(";
    for (std::size_t k = first; k < s.arguments.size(); ++k)
        call += (k == first ? "" : ", ") + c_argument(s.arguments[k], static_cast<int>(k));
    call += ")";
    const bool answers = s.returned.kind != Kind::nothing;
    text += "    " + (answers ? (cpp ? "auto" : s.returned.name) + " lb_r = " : "") + call + ";\n    *lb_hit = 1;\n";
    std::string result = "lb_r";
    if (s.hit_is_optional) {
        text += "    *lb_hit = lb_r ? 1 : 0;\n    if (!lb_r) return;\n    auto lb_value = *lb_r;\n";
        result = "lb_value";
    }
    const auto from = [&](const Slot& slot) {
        const std::string base = slot.argument < 0 ? "(unsigned char*)&" + result : buffer(slot.argument);
        return base + " + " + std::to_string(slot.at);
    };
    if (s.hit)
        text += "    { unsigned long long lb_v = 0; __builtin_memcpy(&lb_v, " + from(*s.hit) + ", " +
                std::to_string(s.hit->size) + "); *lb_hit = lb_v != 0; }\n";
    int k = 0;
    for (const std::optional<Slot>& slot : {s.t, s.far}) {
        if (slot)
            text += "    { " + number_name(slot->size, s.language) + " lb_v; __builtin_memcpy(&lb_v, " + from(*slot) +
                    ", sizeof lb_v); lb_out[" + std::to_string(k) + "] = (" + number + ")lb_v; }\n";
        ++k;
    }
    return text + "}\n";
}

std::string rust_wrapper(const UserSignature& s, const std::string& text_of_file) {
    const std::string number = number_name(static_cast<std::size_t>(s.bits) / 8, s.language);
    std::string text = text_of_file +
                       "\n#[repr(align(64))] struct LostbitsBytes<const N: usize>([u8; N]);\n"
                       "#[no_mangle] #[allow(warnings)] pub unsafe extern \"C\" fn lostbits_entry(lb_input: *const " +
                       number + ", lb_out: *mut " + number +
                       ", lb_hit: *mut i32) { unsafe {\n    let lb_in = &*(lb_input as *const [" + number + "; 64]);\n";
    for (std::size_t k = 0; k < s.arguments.size(); ++k) {
        const std::size_t size = std::max<std::size_t>(s.arguments[k].target().size, 1);
        text += "    let mut " + buffer(static_cast<int>(k)) + " = LostbitsBytes::<" + std::to_string(size) + ">([0; " +
                std::to_string(size) + "]);\n";
    }
    for (const InputSlot& in : s.inputs) {
        std::string source = in.source;
        const std::string type = number_name(in.slot.size, s.language);
        if (source.starts_with("1 / ")) source = "1.0 / lb_" + source.substr(4);
        else source = source == "0" ? "0.0" : "lb_" + source;
        text += "    *(" + buffer(in.slot.argument) + ".0.as_mut_ptr().add(" + std::to_string(in.slot.at) +
                ") as *mut " + type + ") = (" + source + ") as " + type + ";\n";
    }
    text += "    let lb_r = " + s.call + "(";
    for (std::size_t k = 0; k < s.arguments.size(); ++k) {
        const Argument& a = s.arguments[k];
        const std::string bytes = buffer(static_cast<int>(k)) + ".0";
        if (k > 0) text += ", ";
        if (a.type.kind != Kind::pointer) text += "core::ptr::read(" + bytes + ".as_ptr() as *const _)";
        else if (a.type.name.starts_with("*")) text += bytes + ".as_mut_ptr() as *mut _";
        else if (a.type.is_const) text += "&*(" + bytes + ".as_ptr() as *const _)";
        else text += "&mut *(" + bytes + ".as_mut_ptr() as *mut _)";
    }
    text += ");\n    *lb_hit = 1;\n";
    if (s.hit_is_optional) text += "    match lb_r { None => { *lb_hit = 0; } Some(lb_value) => {\n";
    const std::string result = s.hit_is_optional ? "lb_value" : "lb_r";
    const auto from = [&](const Slot& slot) {
        const std::string base =
            slot.argument < 0 ? "(&" + result + " as *const _ as *const u8)" : buffer(slot.argument) + ".0.as_ptr()";
        return base + ".add(" + std::to_string(slot.at) + ")";
    };
    if (s.hit) text += "    *lb_hit = (*" + from(*s.hit) + " != 0) as i32;\n";
    int k = 0;
    for (const std::optional<Slot>& slot : {s.t, s.far}) {
        if (slot)
            text += "    *lb_out.add(" + std::to_string(k) + ") = *(" + from(*slot) + " as *const " +
                    number_name(slot->size, s.language) + ") as " + number + ";\n";
        ++k;
    }
    return text + (s.hit_is_optional ? "    } }\n" : "") + "} }\n";
}

}  // namespace

std::string wrapper_of(const UserSignature& s, const std::string& path) {
    return s.language == SourceLanguage::rust ? rust_wrapper(s, path) : c_wrapper(s, path);
}

}  // namespace lostbits::intersect::function
