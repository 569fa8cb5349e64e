// What the pictures of speed against accuracy say of whose time and whose accuracy they show.
#include "catch.hpp"
#include "measure/rows.hpp"
#include "output/speed/trade_files.hpp"

namespace lostbits::test {

TEST_CASE("a picture of another set of rays says that its times are those of easy rays", "[trade]") {
    const measure::evaluate::TestedForm row = test::row("sphere.unified", "f32");
    const std::vector<const measure::metric::Metric*> metrics{measure::metric::find_metric("lost_bits"),
                                                              measure::metric::find_metric("excess_bits")};
    const measure::speed::TradeRequest request{
        .kernels = {{row, row.form->info, "scalar"}}, .metrics = metrics, .loads = {{"l1", 1024, 0.5}}};
    measure::speed::TradeResult result{.times = {{{}}}, .operations = {{}}, .row_of = {0}, .rows = {}};
    const auto sets = measure::speed::ray_sets(Shape::sphere);
    for (std::size_t s = 0; s < sets.size(); ++s) result.rows.emplace_back().emplace_back(metrics);
    REQUIRE(sets.size() > 1);
    for (std::size_t s = 0; s < sets.size(); ++s) {
        const auto spec = output::speed::trade_plot(request, result, s);
        INFO(spec.subtitle.front());
        const auto says = [&](const std::string& words) {
            return spec.subtitle.front().find(words) != std::string::npos;
        };
        CHECK(says("of the set " + std::string(sets[s].name) + "."));
        CHECK(says("rays as those of the set easy"));
        CHECK(says("the same in the pictures of all sets") == (s > 0));
        CHECK(spec.x.title.find("of the easy set") != std::string::npos);
    }
}

}  // namespace lostbits::test
