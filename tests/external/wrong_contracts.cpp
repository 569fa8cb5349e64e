// A library with a contract that makes no sense; $ODD_CONTRACT selects which.
#include <cstdlib>
#include <cstring>

#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

namespace {

Answer<float> any(const Ray<float>&, const Sphere<float>&) { return miss; }

lb_form chosen() {
    const char* const mistake = std::getenv("ODD_CONTRACT");
    const auto is = [mistake](const char* word) { return mistake != nullptr && std::strcmp(mistake, word) == 0; };
    lb_form f = form<any>("wrong.form");
    if (is("no_name")) f.name = nullptr;
    if (is("name")) f.name = "../../etc/passwd";
    if (is("no_dot")) f.name = "sphere";
    if (is("ours")) f.name = "sphere.mine";
    if (is("shape")) f.shape = 99;
    if (is("format")) f.format = 16;
    if (is("roots")) f.roots = -1;
    if (is("flags")) f.flags = 1024;
    if (is("line")) f.flags = LB_LINE, f.roots = LB_FIRST;
    if (is("title")) f.title = "two\nlines";
    if (is("run")) f.run = nullptr;
    return f;
}

}  // namespace

extern "C" const lb_form* lostbits_forms(int abi, std::size_t* count) {
    static lb_form forms[2];
    forms[0] = chosen();
    forms[1] = chosen();
    const char* const mistake = std::getenv("ODD_CONTRACT");
    const bool twice = mistake != nullptr && std::strcmp(mistake, "twice") == 0;
    *count = mistake != nullptr && std::strcmp(mistake, "none") == 0 ? 0 : twice ? 2 : 1;
    if (mistake != nullptr && std::strcmp(mistake, "version") == 0) return nullptr;
    return abi == LOSTBITS_PLUGIN_ABI ? forms : nullptr;
}
