// Whether the model's size fits what the image shows. A model in a wrong unit is found nowhere, or as something else.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "apps/part_model/model_input.hpp"
#include "core/evidence/verdict.hpp"
#include "core/observation/observation.hpp"
#include "raycast/mesh_loader.hpp"

namespace nearpose::program {

// How large the things in an image are.
struct SeenSize {
    double size_m = 0.0;        // of the segmented region; without one how wide the view is at the depth of its middle
    bool is_segmented = false;  // the object's pixels are known
    bool is_cut = false;        // the region meets the image's border, and goes on behind it
};

// Nothing where the image shows nothing.
std::optional<SeenSize> seen_size(const Observation& observation);

// The unit in which a model that was read in `unit` would fit what is seen, where it does not fit as it is; the nearest
// where several do.
std::optional<LengthUnit> fitting_unit(double diameter_m, LengthUnit unit, const SeenSize& seen);

// Over the frames of a run.
class UnitCheck {
  public:
    UnitCheck(ModelOptions model, double diameter_m) : model_(std::move(model)), diameter_m_(diameter_m) {}

    // A sentence for the user after the fifth frame, or the last of fewer, where none was accepted and another unit
    // would fit what was seen; else nothing.
    std::optional<std::string> after(const Observation& observation, Verdict verdict, bool is_last);

  private:
    ModelOptions model_;
    double diameter_m_;
    int frames_ = 0;
    bool is_done_ = false;
    std::optional<SeenSize> seen_;
};

// That sentence.
std::optional<std::string> unit_notice(const ModelOptions& model, double diameter_m, const SeenSize& seen);

}  // namespace nearpose::program
