// The signature of a user's function, from its debug information: which arguments belong to the ray and to the
// primitive, and how the function answers. It is guessed from names and types; a comment of the file or the option
// overrides the guess.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "intersect/external/contract.hpp"
#include "intersect/function/ir.hpp"

namespace lostbits::intersect::function {

enum class SourceLanguage { c, cpp, rust, llvm };

/// A type as written in the source.
struct SourceType {
    enum class Kind { nothing, number, integer, pointer, structure, sequence, optional, other };
    Kind kind = Kind::other;
    std::string name;                    ///< as written in the source
    std::size_t size = 0;                ///< in bytes
    bool is_const = false;               ///< true for a pointer or a reference to a constant target
    std::vector<SourceType> parts = {};  ///< members; or a single part: the item, the target, or the value of an
                                         ///< optional
    std::string member = {};             ///< name as a member
    std::size_t offset = 0;              ///< offset as a member
    std::size_t count = 0;               ///< number of items of a sequence
    std::size_t flag_offset = 0, flag_size = 0;  ///< the integer that is 0 if an optional is empty; size 0: unknown
};

struct Argument {
    std::string name;
    SourceType type;
    bool is_this = false;
    [[nodiscard]] const SourceType& target() const {
        return type.kind == SourceType::Kind::pointer ? type.parts[0] : type;
    }
};

/// A number at an offset of an argument, or of the returned value.
struct NumberSlot {
    int argument = -1;  ///< -1: the returned value
    std::size_t offset = 0;
    std::size_t size = 0;
    bool is_integer = false;
};

/// A slot and the expression of the number that is written to it: `in[3]`, `1 / in[3]` or `0`.
struct InputSlot {
    NumberSlot slot;
    std::string source;
};

/// The value of t that means a miss.
struct MissValue {
    enum class Kind {
        unknown,   ///< not stated; guessed from the constants that t may be
        none,      ///< no t means a miss
        negative,  ///< t < 0
        infinite,
        nan,
        zero,    ///< t ≤ 0
        above,   ///< t ≥ `bound`
        crossed  ///< near > far, or far < 0
    };
    Kind kind = Kind::unknown;
    double bound = 0;
};

struct UserSignature {
    SourceLanguage language{};
    std::string call;    ///< name of the function in the source
    std::string symbol;  ///< name of the function in the LLVM IR
    std::string folder;  ///< folder of the source file; empty without debug information
    int line = 0;        ///< line of the definition of the function in that file
    bool is_method = false;
    std::vector<Argument> arguments;
    SourceType returned;
    int bits = 32;
    std::vector<InputSlot> inputs;
    std::optional<NumberSlot> hit, t, far;
    bool hit_is_optional = false;  ///< the returned optional is empty for a miss
    MissValue miss_value;
    external::Contract contract;
    std::string text;  ///< the guessed signature in one line, for the user
};

/// Signature of a function as the option or a comment states it: `lostbits: sphere(o, d, c, r) -> t, miss = -1, roots =
/// near`.
struct StatedSignature {
    std::string shape;
    std::vector<std::string> roles;  ///< roles of the vectors and numbers of all arguments, in order
    bool has_roles = false;
    std::vector<std::pair<std::string, std::string>> properties;  ///< key and value
    std::string message_prefix;                                   ///< the option, or the position of the comment
};
StatedSignature stated_signature(const std::string& text, const std::string& message_prefix);
/// Reads the text after `lostbits:` in a comment inside the function that is defined at line `definition`, or directly
/// above it. Without such a comment, combines the comments that do not stand above a function.
StatedSignature read_signature_in_comments(const std::string& source, const std::string& path, int definition);
/// Returns the shape that the user states. Throws InputError with the known names for any other text.
Shape stated_shape(const StatedSignature& stated);
/// Sets a property that the user states. Throws InputError with `message_prefix` in front for an unknown key or an
/// invalid value.
void apply_stated_property(UserSignature& signature, const std::string& key, const std::string& text,
                           const std::string& message_prefix);

/// Counts the numbers of a type that consists only of numbers of one size; -1 if the type holds anything else, or too
/// many numbers. `last_member` receives the normalized name of the last member.
int count_numbers(const SourceType& type, std::size_t& size, std::string& last_member);
/// True if the numbers of a type follow one another and their names say no more than x, y, z: an array, a struct that
/// holds only numbers, or a struct around one of these. In `{vec3 centre; float radius}` each member has a meaning of
/// its own, and there may be padding between them.
bool is_sequence_of_numbers(const SourceType& type);

/// A vector or a number of an argument, and the names from which its role is guessed.
///
/// The role is o, d, 1/d, tmin or tmax for a part of the ray, t, far or hit for an answer, the name `key_role` for a
/// part of the primitive, - for a part without a meaning, or empty while it is unknown.
struct ArgumentPart {
    NumberSlot slot;
    bool is_vector = false;
    std::string path;                 ///< expression in the source: "ray.origin"
    std::string last_name;            ///< the last name of the path, normalized
    std::string argument_names = {};  ///< normalized names of the argument and its type
    bool is_out = false;              ///< true if the function writes the part
    bool points_to_numbers = false;   ///< argument of type float*, which may be one number or three
    bool has_fourth = false;          ///< a vector of four numbers, whose last one may be a radius
    /// Slots of x, y and z, if they are three arguments or members with names of their own: ox, oy, oz.
    std::vector<NumberSlot> components = {};
    int component = -1;  ///< the component that a role such as `o.y` names; −1: the part is a whole
    std::string role = {};
};

/// The role of the key with index k; `key_index` is its inverse. No shape has ten keys.
inline std::string key_role(std::size_t k) { return "k" + std::to_string(k); }
inline std::size_t key_index(const std::string& role) { return static_cast<std::size_t>(role[1] - '0'); }

bool is_answer_role(const std::string& role);
bool has_role(const std::vector<ArgumentPart>& parts, const std::string& role);

/// Lists the vectors and numbers of the arguments, in order. Numbers that follow one another are vectors where their
/// count allows it.
std::vector<ArgumentPart> list_parts(const std::vector<Argument>& arguments);
/// Joins three numbers to a vector if their names differ in a last x, y and z only: `ox, oy, oz` is the vector `o`.
void join_named_components(std::vector<ArgumentPart>& parts);
/// Returns the last number of a vector of four numbers as a part of its own.
ArgumentPart fourth_number_of(ArgumentPart vector);

/// Gives the parts the roles that a comment states, in the order of the arguments. A role that is a vector takes three
/// numbers where the arguments are numbers; `o.y` names one of them. Throws InputError for a role that its part cannot
/// have, for one that is named twice, and for an input without a role.
void apply_stated_roles(std::vector<ArgumentPart>& parts, Shape shape, const StatedSignature& stated);

/// True if a source contains the last part of a name, such as `hit` of `Sphere::hit<float>`, as a word.
bool contains_word(const std::string& source, const std::string& name);
/// Returns the message that a file does not have the function, with a list of the functions that the file defines. `ir`
/// is the LLVM IR of the file.
std::string describe_missing_function(const std::string& ir, const std::string& path, const std::string& name,
                                      SourceLanguage language);
/// Returns the expression of the number at an offset of an argument, as the source writes it: `ray->origin[1]`.
std::string part_text(const Argument& argument, std::size_t offset);
/// Reads the signature from the debug information of a module. Without debug information, the types are those of the
/// LLVM IR. Throws InputError if the function does not exist.
UserSignature read_signature(Module& module, const std::string& path, const std::string& name, SourceLanguage language);
/// Sets the roles of the arguments, the answers and the contract: from `stated` if it has them, else guessed from names
/// and types. Throws InputError, with a comment to write, if a role cannot be guessed.
void guess_signature(UserSignature& signature, const StatedSignature& stated, const std::string& message_prefix);

/// Returns the text of a file that includes the file at the path `file` and defines `lostbits_entry(in, out, hit)`,
/// which calls the user's function. For Rust, `file` is the text of the user's file, which then precedes the new
/// function.
std::string write_wrapper(const UserSignature& signature, const std::string& file);
/// Returns the text of the LLVM IR module followed by the new function.
std::string write_ir_wrapper(const UserSignature& signature, Module& module, const std::string& message_prefix);

}  // namespace lostbits::intersect::function
