#include "core/result.hpp"

namespace nearpose {

const char* to_string(UpdateStatus status) {
    switch (status) {
        case UpdateStatus::kEstimated:
            return "estimated";
        case UpdateStatus::kPredicted:
            return "predicted";
        case UpdateStatus::kNoPose:
            return "no_pose";
    }
    return "";
}

}  // namespace nearpose
