// The Frictionless description that travels beside the CSV files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "output/file/csv.hpp"

namespace lostbits::output::file {

/// One CSV file of a data package.
struct DataResource {
    std::string file_name;  ///< relative to the folder of the `datapackage.json`, with `/`
    std::string title;      ///< what a row is
    std::vector<Column> columns;
};

/// Writes a Frictionless `datapackage.json` to `path`: each column's type, unit and meaning, and in the property
/// `lostbits` the command and the program that made the files. Same input, same
/// bytes: no timestamps, keys in a fixed order, resources in the order given. Throws EnvironmentError.
void write_datapackage(const std::filesystem::path& path, const std::string& title,
                       const std::vector<DataResource>& resources);

}  // namespace lostbits::output::file
