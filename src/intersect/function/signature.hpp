// The signature of a user's function by its debug information: which argument is the ray's, which the primitive's, and
// how it answers. Guessed from names and types; a comment of the file or the option overrides the guess.
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
    enum class Kind { nothing, number, whole, pointer, structure, sequence, optional, other };
    Kind kind = Kind::other;
    std::string name;                        ///< as the source would write it
    std::size_t size = 0;                    ///< in bytes
    bool is_const = false;                   ///< true for a pointer or a reference whose target is not written
    std::vector<SourceType> parts = {};      ///< members, or one: the item, the target, the value of an optional
    std::string member = {};                 ///< name of this member
    std::size_t at = 0;                      ///< offset of this member
    std::size_t count = 0;                   ///< number of items of a sequence
    std::size_t flag_at = 0, flag_size = 0;  ///< the number that is 0 if an optional is empty; size 0: unknown
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
struct Slot {
    int argument = -1;  ///< -1: the returned value
    std::size_t at = 0;
    std::size_t size = 0;
    bool is_whole = false;
};

/// A slot and the number that is written there: `in[3]`, or `1 / in[3]`.
struct InputSlot {
    Slot slot;
    std::string source;
};

/// The value of t that means a miss.
struct MissValue {
    enum class Kind {
        unknown,
        none,
        negative,
        infinite,
        nan,
        zero,
        above,
        crossed
    };  ///< crossed: near > far, or far < 0
    Kind kind = Kind::unknown;
    double bound = 0;
};

struct UserSignature {
    SourceLanguage language{};
    std::string call;    ///< the function as the source calls it
    std::string symbol;  ///< the function in the LLVM IR
    std::string folder;  ///< folder of the source file, if debug information names it
    int line = 0;        ///< line of its definition in that file
    bool is_method = false;
    std::vector<Argument> arguments;
    SourceType returned;
    int bits = 32;
    std::vector<InputSlot> inputs;
    std::optional<Slot> hit, t, far;
    bool hit_is_optional = false;  ///< the returned optional is empty for a miss
    MissValue sentinel;
    external::Contract contract;
    std::string shown;  ///< the guess in one line
};

/// The words of a comment `lostbits: sphere(o, d, c, r) -> t, miss = -1, roots = near`, or of the option.
struct Stated {
    std::string shape;
    std::vector<std::string> roles;  ///< roles of the vectors and numbers of all arguments, in order
    bool has_roles = false;
    std::vector<std::pair<std::string, std::string>> words;  ///< key and value
    std::string where;
};
Stated stated_by(const std::string& text, const std::string& where);
/// Reads the words after `lostbits:` in a comment directly above the function defined at that line. Without such a
/// comment, those that stand above no other function are used together.
Stated stated_in(const std::string& source, const std::string& path, int definition);

/// True if a source contains the last part of a name, such as `hit` of `Sphere::hit<float>`, as a word.
bool mentions(const std::string& source, const std::string& name);
/// Message about a function that a file lacks, with the functions that the file defines. `ir` is its LLVM IR.
std::string no_function(const std::string& ir, const std::string& path, const std::string& name,
                        SourceLanguage language);
/// The number at an offset of an argument, as the source writes it: `ray->origin[1]`.
std::string text_of_part(const Argument& argument, std::size_t at);
/// Reads the signature from the debug information of a module. LLVM IR without debug information gives its types.
/// InputError if the function does not exist.
UserSignature signature_of(Module& module, const std::string& path, const std::string& name, SourceLanguage language);
/// Guesses the rest of it. InputError, which says what to write, if an argument has no meaning that can be guessed.
void guess(UserSignature& s, const Stated& stated, const std::string& who);

/// Returns the text of a file with a function `lostbits_entry(in, out, hit)` that calls the user's function. It
/// includes the file of that path. For Rust, `file` is the text of the file, which stands before the new function.
std::string wrapper_of(const UserSignature& s, const std::string& file);
/// The same for LLVM IR: the text of the module, and the new function.
std::string ir_wrapper_of(const UserSignature& s, Module& module, const std::string& who);

}  // namespace lostbits::intersect::function
