// What stands around the part in clutter and in a bin, and how much of the part it hides.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "apps/scenes/world.hpp"
#include "tests/apps/scenes/small_recording.hpp"

namespace nearpose::simulate {
namespace {

TEST(Clutter, HidesAsMuchAsItIsToldWhereMostIsHidden) {
    for (const double occlusion : {0.2, 0.35, 0.5}) {
        RecordingOptions options = small(Scenario::kClutter, 8, static_cast<std::uint64_t>(100.0 * occlusion));
        options.path.occlusion = occlusion;
        const Recording recording(block().mesh, block().part, options);
        double least = 1.0, most = 0.0;
        for (int i = 0; i < recording.num_frames(); ++i) {
            const data_set::ObjectTruth truth = recording.frame(i).truth;
            const double fraction = static_cast<double>(truth.visible_pixels) / truth.silhouette_pixels;
            least = std::min(least, fraction);
            most = std::max(most, fraction);
        }
        EXPECT_NEAR(least, 1.0 - occlusion, 0.03);
        EXPECT_GE(least, 1.0 - occlusion - 0.003);
        EXPECT_LT(most, 1.0 - occlusion + 0.2);
    }
}

TEST(Clutter, TellsOfTheOtherBuiltInPart) {
    RecordingOptions options = small(Scenario::kClutter, 2);
    const SimulatedFrame frame = Recording(block().mesh, block().part, options).frame(0);
    ASSERT_EQ(frame.others.size(), 1u);
    EXPECT_NE(frame.others[0].truth.object_id, 1);
    EXPECT_GT(frame.others[0].truth.silhouette_pixels, 0);
    const double drawn = static_cast<double>(frame.truth.visible_pixels) / frame.truth.silhouette_pixels;
    EXPECT_GE(drawn, 0.497);
    options.part_name.clear();  // a data set of one object
    EXPECT_TRUE(Recording(block().mesh, block().part, options).frame(0).others.empty());
}

TEST(Bin, CopiesTouchButDoNotMeet) {
    for (const std::string& name : part_names()) {
        const EmbeddedPart part = embedded_part(name);
        const Eigen::AlignedBox3d box(part.part.extent.box_min_in_object, part.part.extent.box_max_in_object);
        std::vector<Pose> poses = pushed_together(part.part, 5);
        ASSERT_EQ(poses.size(), 8u);
        Pose first;
        first.translation = Eigen::Vector3d(0.0, 0.0, 0.5 * box.sizes().z()) - box.center();
        poses.push_back(first);
        for (std::size_t a = 0; a < poses.size(); ++a) {
            double nearest_m = std::numeric_limits<double>::infinity();
            for (std::size_t b = 0; b < poses.size(); ++b) {
                if (a == b) continue;
                const Pose b_from_a = poses[b].inverse() * poses[a];
                for (const Eigen::Vector3f& vertex : part.mesh.vertices_in_object) {
                    ASSERT_GT(box.exteriorDistance(b_from_a * vertex.cast<double>().eval()), 0.0) << name;
                }
                for (int corner = 0; corner < 8; ++corner) {
                    const auto which = static_cast<Eigen::AlignedBox3d::CornerType>(corner);
                    nearest_m = std::min(nearest_m, box.exteriorDistance(b_from_a * box.corner(which)));
                    nearest_m = std::min(nearest_m, box.exteriorDistance(b_from_a.inverse() * box.corner(which)));
                }
            }
            EXPECT_LT(nearest_m, 6e-4) << name;  // the boxes touch but for half a millimetre
            EXPECT_NEAR((poses[a] * box.center()).z(), 0.5 * box.sizes().z(), 1e-12);
        }
    }
}

TEST(Bin, TracksTheCopyInTheMiddleAndTellsOfTheOthers) {
    std::set<bool> turned;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const Recording recording(block().mesh, block().part, small(Scenario::kBin, 2, seed));
        const SimulatedFrame frame = recording.frame(1);
        turned.insert(eye_of(frame.camera_from_object).z() < 0.0);
        ASSERT_EQ(frame.others.size(), 8u);
        std::vector<int> owners(frame.visible.value.size(), 0);
        int visible_others = 0;
        const double off_axis = frame.camera_from_object.translation.head<2>().norm();
        for (const OtherInstance& other : frame.others) {
            EXPECT_EQ(other.truth.object_id, 1);
            EXPECT_LT(off_axis, other.truth.camera_from_object.translation.head<2>().norm());
            visible_others += other.truth.visible_pixels > 0 ? 1 : 0;
            for (std::size_t i = 0; i < owners.size(); ++i) owners[i] += other.visible.value[i] != 0 ? 1 : 0;
        }
        for (std::size_t i = 0; i < owners.size(); ++i) owners[i] += frame.visible.value[i] != 0 ? 1 : 0;
        EXPECT_EQ(*std::max_element(owners.begin(), owners.end()), 1);
        EXPECT_GE(visible_others, 3);
        EXPECT_GT(frame.truth.visible_pixels, frame.truth.silhouette_pixels / 2);
    }
    EXPECT_EQ(turned.size(), 2u);  // either way up
}

}  // namespace
}  // namespace nearpose::simulate
