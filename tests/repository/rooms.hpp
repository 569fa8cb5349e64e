// The rooms of the house, as src/README.md lists them, and what holds in each.
#pragma once

#include <string>
#include <vector>

#include "repository/rules.hpp"

namespace lostbits::test {

/// The rooms in include order (`number`, `measure/truth`, …), from the table of src/README.md; last the program.
std::vector<std::string> rooms_in(const std::string& readme);

/// A file lies in a room, and includes its own and rooms above it; our own headers are named from src/ (the program's
/// own, in analysis/, by their bare name).
Offences include_directions(const std::vector<std::string>& rooms, const SourceFile& file);

/// A file of a room opens that room's namespace and no other, but to specialise what another room declares.
Offences room_namespace(const SourceFile& file);

/// A name that is defined at namespace scope, outside of anonymous namespaces.
struct Definition {
    std::string path;
    std::size_t line;
    std::string name;   ///< with its namespaces; of an inline function with its parameters
    std::string plain;  ///< of a type: the last part alone; empty for a function
};
std::vector<Definition> definitions_in(const SourceFile& file);

/// No two definitions of one qualified name (undefined behaviour, and no linker says so), and no two types of one name
/// in different namespaces (a reader takes one for the other).
Offences names_are_unique(const std::vector<SourceFile>& files);

/// A room that nobody can survey: more than 22 files. The rooms of forms grow with the forms.
Offences room_sizes(const std::vector<SourceFile>& files);

}  // namespace lostbits::test
