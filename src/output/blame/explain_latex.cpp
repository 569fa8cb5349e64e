#include <fmt/format.h>

#include "measure/blame/tape_text.hpp"
#include "output/blame/explain_text.hpp"

namespace lostbits::output::blame {

std::string explain_latex(const measure::blame::Explanation& x) {
    const measure::blame::TapeText text(x.tape, x.names, measure::blame::TapeText::Style::latex);
    std::string form;
    for (const char c : x.form->info->name) form += c == '_' ? "\\_" : std::string(1, c);
    std::string latex = fmt::format(
        "% {} in {}; needs amsmath. Boxed: the culprit. Under braces: bits that cancel.\n\\begin{{align*}}\n",
        x.form->info->name, x.format.name);
    std::string lines;
    for (NodeId i = 0; i < x.tape.size(); ++i) {
        const measure::blame::OperationError& e = x.attribution.of[static_cast<std::size_t>(i)];
        const bool culprit = i == x.attribution.culprit;
        if (!e.live || !is_operation(x.tape[i].op)) continue;
        if (x.tape[i].label.empty() && !culprit && e.cancelled < 2) continue;
        std::string right = text.expression(i);
        if (e.cancelled > 1)
            right = fmt::format("\\underbrace{{{}}}_{{\\text{{{} of {} bits cancel}}}}", right, e.cancelled,
                                x.tape.format_of(i).precision);
        if (culprit) right = fmt::format("\\boxed{{{}}}", right);
        lines += fmt::format("{}  {} &= {}", lines.empty() ? "" : " \\\\\n", text.shown(i), right);
    }
    latex += lines.empty() ? "  & \\text{nothing is computed on the way to the answer}" : lines;
    return latex + "\n\\end{align*}\n";
}

}  // namespace lostbits::output::blame
