// Functions of users in C, C++, Rust, GLSL, HLSL, SPIR-V and LLVM IR as intersectors. A function is compiled to compute
// its answers; its LLVM IR is read for all measurements of operations.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "intersect/external/foreign_batch.hpp"
#include "intersect/function/ir.hpp"
#include "intersect/process/stop_token.hpp"
#include "intersect/table/written_formula.hpp"

namespace lostbits::intersect::function {

struct CompileSettings {
    double seconds = 30;  ///< limit for each run of a compiler
    process::StopToken stop = {};
    std::filesystem::path headers = {};  ///< folder of the headers that the file includes; empty: the file's own folder
};

/// A number that has a name in the user's function: a variable, a part of a variable, or a part of an argument.
struct NamedNumber {
    std::string text;          ///< name as the source writes it: `b`, `v[0]`, `ray->origin[0]`
    NodeId operation;          ///< index of the operation; `no_node` for an argument
    int place = -1;            ///< index in `places` of the statement that sets the variable
    int declaration_line = 0;  ///< line of the declaration
    int input = -1;            ///< index of the input that an argument receives; -1 for a variable
    bool is_inverse = false;   ///< true if the argument receives 1 / input
};

/// The language in which the user's file is written.
enum class FileLanguage { c, cpp, rust, glsl, hlsl, other };

/// A function under test. It cannot be copied or moved, since its table rows point into it.
struct UserFunction {
    UserFunction();
    ~UserFunction();
    UserFunction(const UserFunction&) = delete;
    UserFunction& operator=(const UserFunction&) = delete;

    std::string path;           ///< path of the user's file
    std::string option_suffix;  ///< `:NAME` or `:NAME:SIGNATURE`, the rest of the option
    FileLanguage language = FileLanguage::other;
    int bits = 32;               ///< bits of the function's number format: 32 or 64
    int line = 0;                ///< line of the function's definition
    std::string source;          ///< text of the file; for bitcode its LLVM IR, for SPIR-V its assembly
    std::string signature_text;  ///< the guessed signature in one line
    std::unique_ptr<external::ForeignIntersector> answers;  ///< the compiled function as a row
    std::unique_ptr<table::WrittenForm> written;            ///< the recorded operations of the function
    std::vector<SourcePlace> places;                        ///< the places of operations in the source
    std::vector<int> place_of_operation;                    ///< index of the place of each operation; -1: none
    std::vector<NamedNumber> names;  ///< arguments, then variables in the order in which they are set
    table::Intersector intersector = {.info = nullptr, .shape = {}, .native32 = {}, .native64 = {}};
};

/// Compiles `FILE.c:NAME` (with a signature after another colon, if given) and reads its operations. Throws InputError
/// if the file does not compile or an operation cannot be followed, and EnvironmentError if there is no compiler.
std::unique_ptr<UserFunction> load_function(const std::string& option, const CompileSettings& settings);

/// Returns the function behind a form; null for other forms.
const UserFunction* function_of(const Info& form);

/// Adds the row of a function to the table, which keeps the function until the program ends.
void register_forms(std::unique_ptr<UserFunction> function);

/// Returns the line of the user's file that contains an operation, marked as compilers mark an error. Empty for other
/// forms and for operations without a place. `node` is the index of the operation on a tape of `format`.
std::string quote_line(const Info& form, const Format& format, NodeId node);
/// Returns the place of an operation, such as `sphere.c:12:20`; empty as for `quote_line`.
std::string place_text(const Info& form, const Format& format, NodeId node);

}  // namespace lostbits::intersect::function
