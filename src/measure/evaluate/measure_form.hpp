// Measures one form and format on a band of rays, reusing truth computed for other forms.
//
// A row is a form in a format (`TestedForm`). A band is a part of the rays, such as some lines of a picture. Columns
// are arrays with one number for each ray of the band, such as the true t.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "measure/columns/columns.hpp"
#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::evaluate {

/// A band, with the inputs and columns that one row needs.
struct FormInputs {
    const truth::Band& band;
    const truth::FormatInputs& inputs;         ///< inputs in the form's format
    const columns::BandTruthColumns& columns;  ///< computed for the row's convention and unit
};

/// Truth of a band that several forms share: the inputs in each of their formats, and the true answers in each unit and
/// by each convention that they use. The band must outlive this object.
class SharedBandTruth {
public:
    /// Also computes κ of the band's hits if a metric needs it.
    SharedBandTruth(truth::Band& band, const std::vector<TestedForm>& tested_forms,
                    const std::vector<const metric::Metric*>& metrics);

    [[nodiscard]] FormInputs inputs_of(const TestedForm& tested_form) const {
        return {band_, inputs_.at(tested_form.format.name), columns_};
    }

private:
    const truth::Band& band_;
    std::map<std::string, truth::FormatInputs> inputs_;
    columns::BandTruthColumns columns_;
};

/// Rays of a band that also get a summary of their own. `rays` holds their indices in rising order.
struct RaySubset {
    std::span<const std::uint32_t> rays;
    FormSummary* summary;
};

/// Does the same as `measure_form` of evaluate.hpp, which computes the columns for one row only.
void measure_form(const FormRequest& request, const FormInputs& form_inputs, FormSummary& summary,
                  std::span<const RaySubset> parts = {});

}  // namespace lostbits::measure::evaluate
