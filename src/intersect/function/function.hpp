// Functions of users in C, C++, Rust, GLSL, HLSL, SPIR-V and LLVM IR as intersectors: compiled for their answers, and
// read as LLVM IR for everything that looks at operations.
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

struct CompileTerms {
    double seconds = 30;  ///< limit for each run of a compiler
    process::StopToken stop = {};
    std::filesystem::path headers = {};  ///< folder of the headers that the file names; empty: its own folder
};

/// A number under its name in the user's function: a variable, or a part of a variable or of an argument.
struct NamedNumber {
    std::string text;         ///< as the source writes it: `b`, `v[0]`, `ray->origin[0]`
    NodeId operation;         ///< index of the operation; none for an argument
    int place = -1;           ///< place of the statement that sets it
    int declared = 0;         ///< line of the declaration
    int input = -1;           ///< number of the input that an argument is
    bool is_inverse = false;  ///< it is 1 / input
};

enum class WrittenIn { c, cpp, rust, glsl, hlsl, other };

/// A function under test. It does not move, since its rows point into it.
struct UserFunction {
    UserFunction();
    ~UserFunction();
    UserFunction(const UserFunction&) = delete;
    UserFunction& operator=(const UserFunction&) = delete;

    std::string path;  ///< path of its file
    std::string name;  ///< `:NAME` or `:NAME:WORDS`, the rest of the option
    WrittenIn language = WrittenIn::other;
    int bits = 32;       ///< format of its numbers
    int line = 0;        ///< line of its definition
    std::string source;  ///< text of the file; for bitcode its LLVM IR, for SPIR-V its assembly
    std::string shown;   ///< the signature as it was guessed, in one line
    std::unique_ptr<external::ForeignRow> answers;
    std::unique_ptr<table::WrittenForm> written;
    std::vector<SourcePlace> places;
    std::vector<int> place_of_operation;  ///< index of the place of each operation; -1: none
    std::vector<NamedNumber> names;       ///< arguments, then variables in the order in which they are set
    table::Intersector row = {.info = nullptr, .shape = {}, .native32 = {}, .native64 = {}};
};

/// Compiles `FILE.c:NAME` (with a signature after another colon, if given) and reads its operations. Throws InputError
/// if the file does not compile or an operation cannot be followed, and EnvironmentError if there is no compiler.
std::unique_ptr<UserFunction> load_function(const std::string& named, const CompileTerms& terms);

/// The function behind a form; null for other forms.
const UserFunction* function_of(const Info& form);

/// Adds it to the table, where it stays.
void register_forms(std::unique_ptr<UserFunction> function);

/// The line of the user's file with an operation of a function, marked as compilers mark an error. Empty for other
/// forms and for operations without a place. `node` is the index of the operation on a tape of that format.
std::string quoted_line(const Info& form, const Format& format, NodeId node);
/// `sphere.c:12:20`, in the same way.
std::string place_words(const Info& form, const Format& format, NodeId node);

}  // namespace lostbits::intersect::function
