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
        nothing,
        boolean,
        integer,
        floating,
        vector,
        matrix,
        sequence,
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
    std::vector<const SpirvType*> parts = {};  ///< members; the item; the target; the result and the parameters
    std::size_t count = 0;                     ///< of the items of a vector, a matrix or a sequence
    /// The item of a sequence, or member k of a structure; null if there is none.
    [[nodiscard]] const SpirvType* part(std::size_t k) const;
};

/// A value in LLVM IR.
struct TypedText {
    const SpirvType* type = nullptr;
    std::string text = {};
    std::string refused = {};  ///< of an address: the sentence about reading there
    [[nodiscard]] std::string typed() const { return type->text + " " + text; }
    /// The type of a lane of a vector; the type itself of others.
    [[nodiscard]] const SpirvType& lane() const {
        return type->kind == SpirvType::Kind::vector ? *type->parts[0] : *type;
    }
};

/// A name between quotation marks, without the characters that would end it.
inline std::string quoted_name(const std::string& text) {
    std::string made = "\"";
    for (const char c : text)
        if (c != '"' && c != '\\' && static_cast<unsigned char>(c) >= ' ') made += c;
    return made + "\"";
}

class Translator {
public:
    Translator(const std::vector<SpirvInstruction>& all, std::string path, const ShaderLines& lines, bool is_opaque);
    /// The module. To be called once.
    std::string module();

private:
    using Kind = SpirvType::Kind;
    using Values = std::vector<TypedText>;

    // Module
    void collect_names();
    void declare(const SpirvInstruction& i);
    void declare_type(const SpirvInstruction& i);
    void declare_constant(const SpirvInstruction& i);
    void declare_variable(const SpirvInstruction& i);
    void add_type(const SpirvInstruction& i, SpirvType type);
    const SpirvType& type_of(const std::string& id, const SpirvInstruction& i) const;
    const SpirvType& simple_type(Kind kind, int bits);
    const SpirvType& vector_of(const SpirvType& lane, std::size_t count);
    const SpirvType& pointer_to(const SpirvType& target);
    [[nodiscard]] std::string name_of(const std::string& id) const;
    std::string literal(double x, const SpirvType& type) const;

    // Debug information
    std::string note(const std::string& text);
    std::string note_of(const SpirvType& type);
    std::string note_of_vector(const SpirvType& type);
    std::string note_of_structure(const SpirvType& type);
    std::string place_now(const SpirvInstruction& i);

    // Functions
    void function(std::size_t first, std::size_t end);
    std::string parameters_of(std::size_t first, std::size_t end, const std::string& scope);
    [[nodiscard]] bool is_note(const SpirvInstruction& i) const;
    [[nodiscard]] bool is_written_first(std::size_t from, std::size_t end, const std::string& id) const;
    void resolve_phis();
    void instruction(const SpirvInstruction& i);
    bool control(const SpirvInstruction& i);
    bool memory(const SpirvInstruction& i);
    bool composite(const SpirvInstruction& i);
    bool arithmetic(const SpirvInstruction& i);
    bool matrix(const SpirvInstruction& i);
    TypedText extended(const SpirvInstruction& i, const std::string& name, const SpirvType& type, const Values& x);
    TypedText geometric(const std::string& name, const Values& x);
    void variable(const SpirvInstruction& i);
    TypedText element(const SpirvInstruction& i);
    TypedText call(const SpirvInstruction& i);

    // Values
    TypedText value(const std::string& id, const SpirvInstruction& i) const;
    TypedText made(const SpirvType& type, const std::string& text);
    void line(const std::string& text);
    TypedText refuse(const SpirvType& type, const std::string& sentence);
    TypedText binary(const std::string& op, const TypedText& a, const TypedText& b);
    TypedText intrinsic(const std::string& name, const Values& x);
    TypedText compare(const std::string& op, const TypedText& a, const TypedText& b);
    TypedText select(const TypedText& when, const TypedText& a, const TypedText& b);
    TypedText part(const TypedText& whole, std::size_t k);
    TypedText with_part(const TypedText& whole, std::size_t k, const TypedText& part);
    TypedText with_part(const TypedText& whole, const std::vector<std::size_t>& path, std::size_t at,
                        const TypedText& part);
    TypedText joined(const SpirvType& type, const Values& parts);
    TypedText splat(double x, const SpirvType& type);
    TypedText scaled(const TypedText& vector, const TypedText& scalar);
    TypedText dot(const TypedText& a, const TypedText& b);
    TypedText length(const TypedText& a);
    TypedText times(const TypedText& matrix, const TypedText& vector);
    [[nodiscard]] std::string pointer(const SpirvType& target) const { return is_opaque_ ? "ptr" : target.text + "*"; }

    const std::vector<SpirvInstruction>& all_;
    std::string path_;
    const ShaderLines& lines_;
    PlaceFinder places_;
    bool is_opaque_;
    std::map<std::string, SpirvType> types_;
    std::map<std::string, TypedText> values_;
    std::map<std::string, double> wholes_;  ///< integer constants
    std::map<std::string, std::string> names_, strings_;
    struct Written {
        int count = 0;      ///< number of instructions that write to a variable
        std::string value;  ///< the value that the main function writes; empty for others
    };
    std::map<std::string, Written> written_;
    std::map<std::pair<std::string, std::size_t>, std::string> member_names_;
    std::map<std::string, const SpirvInstruction*> functions_;
    std::map<std::string, std::string> notes_of_types_;
    std::map<std::string, int> known_places_;
    std::set<std::string> declarations_;
    std::vector<std::string> metadata_, head_, body_;
    struct OpenPhi {
        std::size_t line;
        const SpirvInstruction* instruction;
    };
    std::vector<OpenPhi> phis_;
    std::string file_, unit_, scope_, place_;
    std::size_t temporaries_ = 0;
};

}  // namespace lostbits::intersect::spirv
