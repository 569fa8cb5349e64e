// The parts of the translation to LLVM IR: types and constants of a module, and the instructions of a function.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "intersect/spirv/assembly.hpp"
#include "intersect/spirv/shader_lines.hpp"

namespace lostbits::intersect::spirv {

struct SpirvType {
    enum class Kind {
        void_type,
        boolean,
        integer,
        floating,
        vector,
        matrix,
        array,
        structure,
        pointer,
        function,
        other
    };
    Kind kind = Kind::other;
    std::string id, text;             ///< name in SPIR-V; text in LLVM IR
    std::size_t size = 0, align = 1;  ///< in bytes, as LLVM lays it out
    int bits = 0;
    bool is_signed = false;
    /// The members of a structure; the item type of a vector, matrix or array; the target of a pointer; the result and
    /// the parameters of a function.
    std::vector<const SpirvType*> parts = {};
    std::size_t count = 0;  ///< number of items of a vector, a matrix or an array
    /// The item of a vector, a matrix or an array, or member k of a structure; null if there is no part k.
    [[nodiscard]] const SpirvType* part(std::size_t k) const;
};

/// A value in LLVM IR.
struct TypedText {
    const SpirvType* type = nullptr;
    std::string text = {};
    std::string refusal_reason = {};  ///< message about an instruction that reads this address; empty if the address
                                      ///< can be read
    [[nodiscard]] std::string typed() const { return type->text + " " + text; }
    /// The type of a lane of a vector; for other types, the type itself.
    [[nodiscard]] const SpirvType& lane() const {
        return type->kind == SpirvType::Kind::vector ? *type->parts[0] : *type;
    }
};

/// A name in quotation marks, without the characters that would end the name.
inline std::string quote_name(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text)
        if (c != '"' && c != '\\' && static_cast<unsigned char>(c) >= ' ') quoted += c;
    return quoted + "\"";
}

class Translator {
public:
    Translator(const std::vector<SpirvInstruction>& instructions, std::string path, const ShaderLines& lines,
               bool has_opaque_pointers);
    /// Translates the module and returns its text. Call it only once.
    std::string translate_module();

private:
    using Kind = SpirvType::Kind;
    using Values = std::vector<TypedText>;

    // Module
    void collect_names();
    void declare(const SpirvInstruction& instruction);
    void declare_type(const SpirvInstruction& instruction);
    void declare_structure(const SpirvInstruction& instruction);
    void declare_constant(const SpirvInstruction& instruction);
    [[nodiscard]] std::string zero_text(const SpirvType& type) const;
    [[nodiscard]] std::string composite_text(const SpirvInstruction& instruction, const SpirvType& type) const;
    void declare_variable(const SpirvInstruction& instruction);
    void add_type(const SpirvInstruction& instruction, SpirvType type);
    const SpirvType& type_of(const std::string& id, const SpirvInstruction& instruction) const;
    /// The type iN of LLVM, N = `bits`, for an integer or a boolean.
    const SpirvType& integer_type(Kind kind, int bits);
    const SpirvType& vector_of(const SpirvType& lane, std::size_t count);
    const SpirvType& pointer_to(const SpirvType& target);
    [[nodiscard]] std::string name_of(const std::string& id) const;
    std::string literal(double x, const SpirvType& type) const;

    // Debug information
    std::string add_metadata(const std::string& text);
    std::string metadata_of(const SpirvType& type);
    std::string add_vector_metadata(const SpirvType& type);
    std::string add_structure_metadata(const SpirvType& type);
    std::string debug_suffix(const SpirvInstruction& instruction);

    // Functions
    void translate_function(std::size_t first, std::size_t end);
    std::string translate_parameters(std::size_t first, std::size_t end, const std::string& scope);
    [[nodiscard]] bool is_debug_info(const SpirvInstruction& instruction) const;
    [[nodiscard]] bool is_written_first(std::size_t first, std::size_t end, const std::string& id) const;
    void resolve_phis();
    void translate_instruction(const SpirvInstruction& instruction);
    bool refuse_unreadable_operand(const SpirvInstruction& instruction);
    bool translate_control(const SpirvInstruction& instruction);
    bool translate_memory(const SpirvInstruction& instruction);
    Values shuffle_lanes(const SpirvInstruction& instruction);
    bool translate_composite(const SpirvInstruction& instruction);
    bool translate_arithmetic(const SpirvInstruction& instruction);
    bool translate_matrix(const SpirvInstruction& instruction);
    TypedText translate_extended_instruction(const SpirvInstruction& instruction, const std::string& name,
                                             const SpirvType& type, const Values& x);
    TypedText translate_geometric(const std::string& name, const Values& x);
    void translate_variable(const SpirvInstruction& instruction);
    TypedText emit_element_address(const SpirvInstruction& instruction);
    TypedText translate_call(const SpirvInstruction& instruction);

    // Values
    TypedText value(const std::string& id, const SpirvInstruction& instruction) const;
    TypedText emit(const SpirvType& type, const std::string& text);
    void emit_line(const std::string& text);
    TypedText refuse(const SpirvType& type, const std::string& sentence);
    TypedText emit_binary(const std::string& op, const TypedText& a, const TypedText& b);
    TypedText emit_intrinsic(const std::string& name, const Values& x);
    TypedText compare(const std::string& op, const TypedText& a, const TypedText& b);
    TypedText select(const TypedText& when, const TypedText& a, const TypedText& b);
    TypedText extract_part(const TypedText& whole, std::size_t k);
    TypedText insert_part(const TypedText& whole, std::size_t k, const TypedText& part);
    TypedText insert_part(const TypedText& whole, const std::vector<std::size_t>& path, std::size_t depth,
                          const TypedText& part);
    TypedText construct(const SpirvType& type, const Values& parts);
    TypedText splat(double x, const SpirvType& type);
    TypedText scale(const TypedText& vector, const TypedText& scalar);
    TypedText dot(const TypedText& a, const TypedText& b);
    TypedText length(const TypedText& a);
    TypedText matrix_times_vector(const TypedText& matrix, const TypedText& vector);
    [[nodiscard]] std::string pointer(const SpirvType& target) const {
        return has_opaque_pointers_ ? "ptr" : target.text + "*";
    }

    const std::vector<SpirvInstruction>& instructions_;
    std::string path_;
    const ShaderLines& lines_;
    PlaceFinder places_;
    bool has_opaque_pointers_;
    std::map<std::string, SpirvType> types_;
    std::map<std::string, TypedText> values_;
    std::map<std::string, double> integer_constants_;  ///< by id
    std::map<std::string, std::string> names_, strings_;
    struct VariableWrites {
        int count = 0;      ///< number of instructions that write to a variable
        std::string value;  ///< the value that the main function writes; empty if another function writes
    };
    std::map<std::string, VariableWrites> variable_writes_;
    std::map<std::pair<std::string, std::size_t>, std::string> member_names_;
    std::map<std::string, const SpirvInstruction*> functions_;
    std::map<std::string, std::string> metadata_of_types_;
    std::map<std::string, int> known_places_;
    std::set<std::string> declarations_;
    std::vector<std::string> metadata_, definitions_, body_;
    struct PendingPhi {
        std::size_t line;
        const SpirvInstruction* instruction;
    };
    std::vector<PendingPhi> phis_;
    std::string file_, unit_, scope_, place_;
    std::size_t temporary_count_ = 0;
};

}  // namespace lostbits::intersect::spirv
