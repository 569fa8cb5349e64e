#include "output/report/text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "output/file/number_text.hpp"

namespace lostbits::output::report {

std::string prose_html(std::string_view text) {
    std::string result;
    for (;;) {
        const auto open = text.find('`');
        const auto close = open == std::string_view::npos ? open : text.find('`', open + 1);
        if (close == std::string_view::npos) return result + html(text);
        result +=
            fmt::format("{}<code>{}</code>", html(text.substr(0, open)), html(text.substr(open + 1, close - open - 1)));
        text.remove_prefix(close + 1);
    }
}

std::string begin_table(const std::vector<std::string>& names, std::string_view attributes,
                        const std::string& caption) {
    std::string text = fmt::format("<div class=\"scrolls\"><table{}>{}<thead><tr>", attributes,
                                   caption.empty() ? "" : fmt::format("<caption>{}</caption>", caption));
    for (const std::string& name : names) text += fmt::format("<th scope=\"col\">{}</th>", html(name));
    return text + "</tr></thead><tbody>\n";
}

std::string number_html(double value) {
    if (std::isnan(value)) return "&ndash;";
    const std::string rounded = value != 0 && (std::fabs(value) < 1e-3 || std::fabs(value) >= 1e7)
                                    ? fmt::format("{:.2e}", value)
                                    : fmt::format("{:.4g}", value);
    return fmt::format("<data value=\"{}\">{}</data>", file::decimal(value),
                       value == std::floor(value) && std::fabs(value) < 1e7 ? file::decimal(value) : rounded);
}

namespace {

std::string quoted_json(const std::string& text) {
    std::string result;
    for (const char c : Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)) {
        if (c == '<') result += "\\u003c";
        else result += c;
    }
    return result;
}

}  // namespace

Json number_json(double value) {
    if (std::isnan(value)) return nullptr;
    return std::isinf(value) ? Json(file::decimal(value)) : Json(value);
}

Json colour_json(const image::Rgb8& c) { return Json::array({c.r, c.g, c.b}); }

Json scale_json(const image::ColourScale& scale) {
    return {{"lo", number_json(scale.lo())},
            {"hi", number_json(scale.hi())},
            {"spacing", image::spacing_names[static_cast<std::size_t>(scale.spacing())]},
            {"ticks", json_array(scale.ticks(7), [](const image::ColourScale::Tick& tick) {
                 return Json::array({number_json(tick.position), tick.label});
             })}};
}

std::string compact_json(const Json& json) {
    if (json.is_string()) return quoted_json(json.get_ref<const std::string&>());
    if (json.is_number_float()) return file::decimal(json.get<double>());
    if (!json.is_structured()) return json.dump();
    std::string text;
    for (const auto& [key, value] : json.items()) {
        if (!text.empty()) text += ',';
        if (json.is_object()) text += quoted_json(key) + ':';
        text += compact_json(value);
    }
    return json.is_object() ? '{' + text + '}' : '[' + text + ']';
}

}  // namespace lostbits::output::report
