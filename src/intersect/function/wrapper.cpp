// Writes the file that calls a user's function with the numbers of a ray and a primitive. The compiler of this file
// then takes care of the calling convention: structures in registers, references, results in memory.
#include <algorithm>

#include "intersect/function/signature.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

using Kind = SourceType::Kind;

std::string buffer_name(int argument) { return "lb_p" + std::to_string(argument); }

std::string source_number_type(std::size_t size, SourceLanguage language) {
    if (language == SourceLanguage::rust) return size == 4 ? "f32" : "f64";
    return size == 4 ? "float" : "double";
}

/// Returns `*(T*)lb_p0`, or the pointer without the `*`.
std::string c_argument(const Argument& a, int k) {
    const bool is_pointer = a.type.kind == Kind::pointer;
    const SourceType& t = a.target();
    std::string cast = t.kind == Kind::nothing ? "void*" : t.name + "*";
    if (t.kind == Kind::sequence) cast = t.parts[0].name + "(*)[" + std::to_string(t.count) + "]";
    const std::string pointer = "(" + cast + ")" + buffer_name(k);
    if (is_pointer && a.type.name != "&") return pointer;
    return "*(" + pointer + ")";
}

/// Returns `lb_in[3]`, `1 / lb_in[3]` or `0`.
std::string c_source(std::string source) {
    if (const std::size_t position = source.find("in["); position != std::string::npos) source.insert(position, "lb_");
    return source;
}

/// Returns the call with its arguments. The object of a method stands in the first buffer.
std::string c_call(const UserSignature& signature) {
    std::string call = signature.call;
    std::size_t first = 0;
    if (signature.is_method) {
        const std::size_t colon = call.rfind("::");
        call = "((" + call.substr(0, colon) + "*)" + buffer_name(0) + ")->" + call.substr(colon + 2);
        first = 1;
    }
    call += "(";
    for (std::size_t k = first; k < signature.arguments.size(); ++k)
        call += (k == first ? "" : ", ") + c_argument(signature.arguments[k], static_cast<int>(k));
    return call + ")";
}

std::string c_wrapper(const UserSignature& signature, const std::string& path) {
    const bool is_cpp = signature.language == SourceLanguage::cpp;
    const std::string number = source_number_type(static_cast<std::size_t>(signature.bits) / 8, signature.language);
    std::string text = "#include \"" + path + "\"\n" + (is_cpp ? "extern \"C\" " : "") + "void lostbits_entry(const " +
                       number + "* lb_in, " + number + "* lb_out, int* lb_hit) {\n";

    // A buffer for each argument, with its inputs.
    for (std::size_t k = 0; k < signature.arguments.size(); ++k) {
        const std::size_t size = std::max<std::size_t>(signature.arguments[k].target().size, 64);
        text += "    " + std::string(is_cpp ? "alignas(64)" : "_Alignas(64)") + " unsigned char " +
                buffer_name(static_cast<int>(k)) + "[" + std::to_string(size) + "] = {0};\n";
    }
    for (const InputSlot& in : signature.inputs)
        text += "    { " + source_number_type(in.slot.size, signature.language) + " lb_v = " + c_source(in.source) +
                "; __builtin_memcpy(" + buffer_name(in.slot.argument) + " + " + std::to_string(in.slot.offset) +
                ", &lb_v, sizeof lb_v); }\n";

    // The call. Without other information it hits.
    const bool returns_value = signature.returned.kind != Kind::nothing;
    text += "    " + (returns_value ? (is_cpp ? "auto" : signature.returned.name) + " lb_r = " : "") +
            c_call(signature) + ";\n    *lb_hit = 1;\n";
    std::string result = "lb_r";
    if (signature.hit_is_optional) {
        text += "    *lb_hit = lb_r ? 1 : 0;\n    if (!lb_r) return;\n    auto lb_value = *lb_r;\n";
        result = "lb_value";
    }

    // The answers, from the result or from the buffers.
    const auto address_of = [&](const NumberSlot& slot) {
        const std::string base = slot.argument < 0 ? "(unsigned char*)&" + result : buffer_name(slot.argument);
        return base + " + " + std::to_string(slot.offset);
    };
    if (signature.hit)
        text += "    { unsigned long long lb_v = 0; __builtin_memcpy(&lb_v, " + address_of(*signature.hit) + ", " +
                std::to_string(signature.hit->size) + "); *lb_hit = lb_v != 0; }\n";
    int k = 0;
    for (const std::optional<NumberSlot>& slot : {signature.t, signature.far}) {
        if (slot)
            text += "    { " + source_number_type(slot->size, signature.language) + " lb_v; __builtin_memcpy(&lb_v, " +
                    address_of(*slot) + ", sizeof lb_v); lb_out[" + std::to_string(k) + "] = (" + number + ")lb_v; }\n";
        ++k;
    }
    return text + "}\n";
}

/// Returns `lb_in[3]`, `1.0 / lb_in[3]` or `0.0`.
std::string rust_source(const std::string& source) {
    constexpr std::string_view reciprocal = "1 / ";
    if (source.starts_with(reciprocal)) return "1.0 / lb_" + source.substr(reciprocal.size());
    return source == "0" ? "0.0" : "lb_" + source;
}

/// Returns the expression that reads an argument from its buffer: a value, a pointer or a reference.
std::string rust_argument(const Argument& a, int k) {
    const std::string bytes = buffer_name(k) + ".0";
    if (a.type.kind != Kind::pointer) return "core::ptr::read(" + bytes + ".as_ptr() as *const _)";
    if (a.type.name.starts_with("*")) return bytes + ".as_mut_ptr() as *mut _";
    if (a.type.is_const) return "&*(" + bytes + ".as_ptr() as *const _)";
    return "&mut *(" + bytes + ".as_mut_ptr() as *mut _)";
}

std::string rust_wrapper(const UserSignature& signature, const std::string& text_of_file) {
    const std::string number = source_number_type(static_cast<std::size_t>(signature.bits) / 8, signature.language);
    std::string text = text_of_file +
                       "\n#[repr(align(64))] struct LostbitsBytes<const N: usize>([u8; N]);\n"
                       "#[no_mangle] #[allow(warnings)] pub unsafe extern \"C\" fn lostbits_entry(lb_input: *const " +
                       number + ", lb_out: *mut " + number +
                       ", lb_hit: *mut i32) { unsafe {\n    let lb_in = &*(lb_input as *const [" + number + "; 64]);\n";

    // A buffer for each argument, with its inputs.
    for (std::size_t k = 0; k < signature.arguments.size(); ++k) {
        const std::size_t size = std::max<std::size_t>(signature.arguments[k].target().size, 1);
        text += "    let mut " + buffer_name(static_cast<int>(k)) + " = LostbitsBytes::<" + std::to_string(size) +
                ">([0; " + std::to_string(size) + "]);\n";
    }
    for (const InputSlot& in : signature.inputs) {
        const std::string type = source_number_type(in.slot.size, signature.language);
        text += "    *(" + buffer_name(in.slot.argument) + ".0.as_mut_ptr().add(" + std::to_string(in.slot.offset) +
                ") as *mut " + type + ") = (" + rust_source(in.source) + ") as " + type + ";\n";
    }

    // The call. Without other information it hits.
    text += "    let lb_r = " + signature.call + "(";
    for (std::size_t k = 0; k < signature.arguments.size(); ++k)
        text += (k == 0 ? "" : ", ") + rust_argument(signature.arguments[k], static_cast<int>(k));
    text += ");\n    *lb_hit = 1;\n";
    if (signature.hit_is_optional) text += "    match lb_r { None => { *lb_hit = 0; } Some(lb_value) => {\n";

    // The answers, from the result or from the buffers.
    const std::string result = signature.hit_is_optional ? "lb_value" : "lb_r";
    const auto address_of = [&](const NumberSlot& slot) {
        const std::string base = slot.argument < 0 ? "(&" + result + " as *const _ as *const u8)"
                                                   : buffer_name(slot.argument) + ".0.as_ptr()";
        return base + ".add(" + std::to_string(slot.offset) + ")";
    };
    if (signature.hit) text += "    *lb_hit = (*" + address_of(*signature.hit) + " != 0) as i32;\n";
    int k = 0;
    for (const std::optional<NumberSlot>& slot : {signature.t, signature.far}) {
        if (slot)
            text += "    *lb_out.add(" + std::to_string(k) + ") = *(" + address_of(*slot) + " as *const " +
                    source_number_type(slot->size, signature.language) + ") as " + number + ";\n";
        ++k;
    }
    return text + (signature.hit_is_optional ? "    } }\n" : "") + "} }\n";
}

// LLVM IR: each parameter receives the bytes of an argument of which it is a part, by the debug information.

std::string ir_number_type(std::size_t size) { return size == 4 ? "float" : "double"; }

/// Writes instructions. Arguments and the result stand in arrays of bytes, %lb.b0, %lb.b1, ...
class IrWriter {
public:
    std::string text;
    const bool has_opaque_pointers;  ///< true if pointers have no type

    explicit IrWriter(const Module& module)
        : has_opaque_pointers(module.text().find("(ptr ") != std::string::npos ||
                              module.text().find(" ptr ") != std::string::npos) {}

    [[nodiscard]] std::string pointer(const std::string& type) const {
        return has_opaque_pointers ? "ptr" : type + "*";
    }
    /// Appends an instruction, and returns the new name of its result.
    std::string emit(const std::string& instruction) {
        std::string name = "%lb." + std::to_string(count_++);
        text += "  " + name + " = " + instruction + "\n";
        return name;
    }
    void new_bytes(std::size_t size) {
        const std::string type = "[" + std::to_string(std::max<std::size_t>(size, 64)) + " x i8]";
        const std::string name = "%lb.b" + std::to_string(bytes_.size());
        bytes_.push_back(type);
        text += "  " + name + " = alloca " + type + ", align 64\n  store " + type + " zeroinitializer, " +
                pointer(type) + " " + name + "\n";
    }
    /// Appends instructions for the address of a byte of an array, as a pointer of type `pointer_type`.
    std::string address(std::size_t array, std::size_t offset, const std::string& pointer_type) {
        const std::string& type = bytes_[array];
        const std::string byte = emit("getelementptr " + type + ", " + pointer(type) + " %lb.b" +
                                      std::to_string(array) + ", i64 0, i64 " + std::to_string(offset));
        return has_opaque_pointers ? byte : emit("bitcast i8* " + byte + " to " + pointer_type);
    }
    std::string load(std::size_t array, std::size_t offset, const std::string& type) {
        return emit("load " + type + ", " + pointer(type) + " " + address(array, offset, type + "*") + ", align 1");
    }
    void store(const std::string& value, std::size_t array, std::size_t offset, const std::string& type) {
        text += "  store " + type + " " + value + ", " + pointer(type) + " " + address(array, offset, type + "*") +
                ", align 1\n";
    }
    /// Appends an instruction for the address of the k-th number of an array of numbers.
    std::string item_address(const std::string& array, const std::string& number, std::size_t k) {
        return emit("getelementptr " + number + ", " + pointer(number) + " " + array + ", i64 " + std::to_string(k));
    }
    std::string convert(const std::string& value, std::size_t from, std::size_t to) {
        if (from == to) return value;
        return emit(std::string(from < to ? "fpext " : "fptrunc ") + ir_number_type(from) + " " + value + " to " +
                    ir_number_type(to));
    }

private:
    std::vector<std::string> bytes_;
    int count_ = 0;
};

/// Writes the parameters of the call. Each takes the bytes of an argument, or of a part of one.
class ParameterWriter {
public:
    ParameterWriter(const UserSignature& signature, const IrFunction& function, IrWriter& writer,
                    const std::string& message_prefix)
        : signature_(signature), f_(function), writer_(writer), message_prefix_(message_prefix) {}

    /// Returns the list of the parameters. The array after the arrays of the arguments receives the result.
    std::string write() {
        const std::size_t result = signature_.arguments.size();
        if (!f_.parameters.empty() && f_.parameters[0].text.find("sret") != std::string_view::npos)
            append(writer_.address(result, 0, std::string(f_.parameters[0].type_text)));
        for (std::size_t k = 0; k < signature_.arguments.size(); ++k) write_argument(k);
        if (next_ != f_.parameters.size()) fail();
        return list_;
    }

private:
    [[noreturn]] void fail() const {
        throw InputError(message_prefix_ +
                         ": its parameters in the LLVM IR are not those of its debug information; the optimiser "
                         "may have changed them: compile it with -O0 -g");
    }

    void append(const std::string& value) {
        list_ += (list_.empty() ? "" : ", ") + std::string(f_.parameters[next_].text) + " " + value;
        ++next_;
    }

    /// Passes an argument by its address, or by value in as many parameters as its size needs.
    void write_argument(std::size_t k) {
        const std::size_t size = signature_.arguments[k].type.size;
        for (std::size_t offset = 0; offset < size;) {
            if (next_ >= f_.parameters.size()) fail();
            const IrParameter& p = f_.parameters[next_];
            const std::string type(p.type_text);
            if (p.type->kind == Type::Kind::pointer) return append(writer_.address(k, 0, type));

            offset = (offset + p.type->align - 1) / p.type->align * p.type->align;
            if (p.type->size == 0 || offset + p.type->size > std::max<std::size_t>(size, 64)) fail();
            const bool is_bit = p.type->kind == Type::Kind::integer && p.type->bits == 1;
            const std::string value = writer_.load(k, offset, is_bit ? "i8" : type);
            append(is_bit ? writer_.emit("trunc i8 " + value + " to i1") : value);
            offset += p.type->size;
        }
    }

    const UserSignature& signature_;
    const IrFunction& f_;
    IrWriter& writer_;
    const std::string& message_prefix_;
    std::string list_;
    std::size_t next_ = 0;  ///< index of the next parameter
};

void write_inputs(const UserSignature& signature, IrWriter& writer) {
    const std::size_t size = static_cast<std::size_t>(signature.bits) / 8;
    const std::string number = ir_number_type(size);
    for (const InputSlot& input : signature.inputs) {
        std::string value = "0.000000e+00";
        if (const std::size_t bracket = input.source.find("in["); bracket != std::string::npos) {
            const std::string address =
                writer.item_address("%in", number, std::stoul(input.source.substr(bracket + 3)));
            value = writer.emit("load " + number + ", " + writer.pointer(number) + " " + address);
            if (input.source.starts_with("1 / ")) value = writer.emit("fdiv " + number + " 1.000000e+00, " + value);
            value = writer.convert(value, size, input.slot.size);
        }
        writer.store(value, static_cast<std::size_t>(input.slot.argument), input.slot.offset,
                     ir_number_type(input.slot.size));
    }
}

/// Writes the call, and stores its result in the array after the arrays of the arguments.
void write_call(const UserSignature& signature, Module& module, const std::string& message_prefix, IrWriter& writer) {
    const IrFunction& f = *module.find_function(signature.symbol);
    const std::string call = "call " + std::string(f.convention) + " " + std::string(f.returned_text) + " @\"" +
                             f.name + "\"(" + ParameterWriter(signature, f, writer, message_prefix).write() + ")";
    const std::size_t result = signature.arguments.size();
    Cursor returned(f.returned_text);
    const Type* const type = module.read_type(returned);
    if (type->kind == Type::Kind::nothing) writer.text += "  " + call + "\n";
    else if (const std::string value = writer.emit(call); type->kind == Type::Kind::integer && type->bits == 1)
        writer.store(writer.emit("zext i1 " + value + " to i8"), result, 0, "i8");
    else writer.store(value, result, 0, std::string(f.returned_text));
}

/// Writes the answers, hit and the numbers t, from the arrays of the arguments and the result.
void write_answers(const UserSignature& signature, const std::string& message_prefix, IrWriter& writer) {
    // The value of an optional is before or after its flag.
    const std::size_t result = signature.arguments.size();
    const SourceType* const value = signature.hit_is_optional ? &signature.returned.parts[0] : nullptr;
    if (value != nullptr && signature.returned.flag_size == 0)
        throw InputError(message_prefix + ": the layout of its optional result is unknown");
    const auto array_of = [&](const NumberSlot& slot) {
        return slot.argument < 0 ? result : static_cast<std::size_t>(slot.argument);
    };
    const auto offset_of = [&](const NumberSlot& slot) {
        return slot.offset + (slot.argument < 0 && value ? value->offset : 0);
    };

    // A hit: the optional has a value, and the flag is not 0.
    std::string hit = "true";
    const auto require_nonzero = [&](std::size_t array, std::size_t offset, std::size_t size) {
        const std::string integer_type = "i" + std::to_string(8 * size);
        const std::string is_nonzero =
            writer.emit("icmp ne " + integer_type + " " + writer.load(array, offset, integer_type) + ", 0");
        hit = hit == "true" ? is_nonzero : writer.emit("select i1 " + hit + ", i1 " + is_nonzero + ", i1 false");
    };
    if (value != nullptr) require_nonzero(result, signature.returned.flag_offset, signature.returned.flag_size);
    if (signature.hit) require_nonzero(array_of(*signature.hit), offset_of(*signature.hit), signature.hit->size);
    writer.text +=
        "  store i32 " + writer.emit("zext i1 " + hit + " to i32") + ", " + writer.pointer("i32") + " %hit\n";

    // The numbers, in the format of the function.
    const std::size_t size = static_cast<std::size_t>(signature.bits) / 8;
    const std::string number = ir_number_type(size);
    std::size_t k = 0;
    for (const std::optional<NumberSlot>& slot : {signature.t, signature.far}) {
        if (slot) {
            const std::string t = writer.load(array_of(*slot), offset_of(*slot), ir_number_type(slot->size));
            const std::string address = writer.item_address("%out", number, k);
            writer.text += "  store " + number + " " + writer.convert(t, slot->size, size) + ", " +
                           writer.pointer(number) + " " + address + "\n";
        }
        ++k;
    }
}

}  // namespace

std::string write_wrapper(const UserSignature& signature, const std::string& file) {
    return signature.language == SourceLanguage::rust ? rust_wrapper(signature, file) : c_wrapper(signature, file);
}

std::string write_ir_wrapper(const UserSignature& signature, Module& module, const std::string& message_prefix) {
    IrWriter writer(module);
    for (const Argument& a : signature.arguments) writer.new_bytes(a.target().size);
    writer.new_bytes(signature.returned.size);
    write_inputs(signature, writer);
    write_call(signature, module, message_prefix, writer);
    write_answers(signature, message_prefix, writer);

    const std::string numbers = writer.pointer(ir_number_type(static_cast<std::size_t>(signature.bits) / 8));
    return module.text() + "\ndefine void @lostbits_entry(" + numbers + " %in, " + numbers + " %out, " +
           writer.pointer("i32") + " %hit) {\n" + writer.text + "  ret void\n}\n";
}

}  // namespace lostbits::intersect::function
