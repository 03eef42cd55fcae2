// What the simulation draws random numbers for: addresses of its streams beside the estimator's own.
#pragma once

#include "core/base/random.hpp"

namespace nearpose::simulate {

inline constexpr auto kPathDraw = static_cast<RandomPurpose>(100);           // the camera's path
inline constexpr auto kWorldDraw = static_cast<RandomPurpose>(101);          // where the world frame is
inline constexpr auto kHandEyeDraw = static_cast<RandomPurpose>(102);        // constant error of the measured motion
inline constexpr auto kArmDraw = static_cast<RandomPurpose>(103);            // error of the measured motion in a frame
inline constexpr auto kPixelDraw = static_cast<RandomPurpose>(104);          // smoothed noise of a frame's pixel
inline constexpr auto kPixelEventDraw = static_cast<RandomPurpose>(105);     // chance events at a frame's pixel
inline constexpr auto kPatchDraw = static_cast<RandomPurpose>(107);          // nodes of a frame's drop-out patches
inline constexpr auto kBiasDraw = static_cast<RandomPurpose>(106);           // nodes of the sensor's fixed error field
inline constexpr auto kFrameBiasDraw = static_cast<RandomPurpose>(120);      // nodes of a frame's own error field
inline constexpr auto kSpecularDraw = static_cast<RandomPurpose>(121);       // nodes of a frame's patches in highlights
inline constexpr auto kDotDraw = static_cast<RandomPurpose>(122);            // a stereo projector's dots
inline constexpr auto kLeftInfraredDraw = static_cast<RandomPurpose>(123);   // noise of an infrared pixel
inline constexpr auto kRightInfraredDraw = static_cast<RandomPurpose>(124);  // the same, of the right camera
inline constexpr auto kTaskDraw = static_cast<RandomPurpose>(130);           // the part's motion and how it lies
inline constexpr auto kThingsDraw = static_cast<RandomPurpose>(131);         // what stands around the part
inline constexpr auto kDropDraw = static_cast<RandomPurpose>(132);           // which frames are dropped
inline constexpr auto kNonsenseDraw = static_cast<RandomPurpose>(133);       // which frames are nonsense, and what
inline constexpr auto kMoveDraw = static_cast<RandomPurpose>(134);           // where the part is put down elsewhere
inline constexpr auto kStandInDraw = static_cast<RandomPurpose>(135);        // how another part lies in its place
inline constexpr auto kBareSceneDraw = static_cast<RandomPurpose>(136);      // where a corner stands
inline constexpr auto kFaultDraw = static_cast<RandomPurpose>(137);          // what a fault does in a frame

}  // namespace nearpose::simulate
