// A contact sheet of lost bits while a scene is mapped: forms across, formats down.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::output::map {

/// Draws the metric `lost_bits` of a map, which must be among the request's. Opened before the map; the file has its
/// name after `finish`.
class SceneSheet {
public:
    /// `named`: what names the scene to `lostbits explain`.
    SceneSheet(const measure::evaluate::EvaluationRequest& request, const std::filesystem::path& path,
               const std::string& named);
    ~SceneSheet();
    SceneSheet(const SceneSheet&) = delete;
    SceneSheet& operator=(const SceneSheet&) = delete;

    /// One per row of the request, in its order.
    [[nodiscard]] std::vector<measure::evaluate::EvaluationSink*> sinks();
    void finish(const std::vector<measure::evaluate::FormSummary>& summaries);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace lostbits::output::map
