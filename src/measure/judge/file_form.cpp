#include <cctype>

#include "measure/judge/judge.hpp"

namespace lostbits::measure::judge {

namespace {

std::string file_word(const std::string& name) {
    std::string word = "file.";
    for (const char c : name)
        word += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ? c : '_';
    return word;
}

}  // namespace

FileForm::FileForm(const std::string& name, Shape shape, const intersect::Info& info)
    : name_(file_word(name)), info_(info) {
    info_.name = name_;
    info_.title = "the answers of a file";
    info_.source = "a file";
    form_.info = &info_;
    form_.shape = shape;
}

}  // namespace lostbits::measure::judge
