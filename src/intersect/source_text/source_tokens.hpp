// The tokens of a text in C, C++, Rust, GLSL or HLSL, and the expressions and statements that the tokens form. There is
// no grammar: only brackets, and how tightly operators bind.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace lostbits::intersect::source_text {

/// A part of a text, from `begin` up to `end`.
struct TextSpan {
    std::size_t begin = 0, end = 0;
    friend auto operator<=>(const TextSpan&, const TextSpan&) = default;
};

/// The text must outlive this object.
class SourceTokens {
public:
    explicit SourceTokens(std::string_view text);

    /// Returns the expression whose operator is at this offset. If a name is at the offset, returns the call or the
    /// operand that begins with the name.
    [[nodiscard]] TextSpan find_expression_at(std::size_t offset) const;
    /// Returns the longest expression that begins at this offset.
    [[nodiscard]] TextSpan find_expression_from(std::size_t offset) const;
    /// Returns the value that `name = value` gives to a variable, if exactly one such statement begins between the two
    /// offsets.
    [[nodiscard]] std::optional<TextSpan> value_of(std::string_view name, std::size_t begin, std::size_t end) const;
    /// Begin of the statement that contains an offset, and the end of the token before the statement.
    struct Statement {
        std::size_t begin = 0, before = 0;
    };
    [[nodiscard]] Statement statement_around(std::size_t offset) const;
    [[nodiscard]] bool has_word(std::string_view word) const;

private:
    struct Token {
        std::size_t begin, end;
        bool is_word;
    };
    [[nodiscard]] std::string_view text_of(std::size_t k) const {
        return text_.substr(tokens_[k].begin, tokens_[k].end - tokens_[k].begin);
    }
    [[nodiscard]] std::size_t index_at(std::size_t offset) const;
    [[nodiscard]] bool is_prefix(std::size_t k) const;
    [[nodiscard]] bool is_binary_sign(std::size_t k) const;
    [[nodiscard]] TextSpan operand_at(std::size_t k) const;
    [[nodiscard]] std::size_t end_of_operand(std::size_t k) const;
    [[nodiscard]] std::size_t end_of_value(std::size_t k) const;
    /// Index of the token after or before token k. A group in brackets counts as one token, from its first or its last
    /// bracket.
    [[nodiscard]] std::size_t index_after(std::size_t k) const;
    [[nodiscard]] std::size_t index_before(std::size_t k) const;

    std::string_view text_;
    std::vector<Token> tokens_;
    std::vector<std::size_t> partner_index_;  ///< index of the matching bracket of each bracket; the token's own index
                                              ///< for other tokens and unmatched brackets
};

}  // namespace lostbits::intersect::source_text
