#include "raycast/mesh_files/ear_clipping.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace nearpose {
namespace {

using Triangles = std::vector<std::array<int, 3>>;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// Newell's: twice the vector area, which needs no three corners that are good.
Eigen::Vector3d normal_of(const std::vector<Eigen::Vector3d>& corners) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = 2; k < corners.size(); ++k)
        sum += (corners[k - 1] - corners[0]).cross(corners[k] - corners[0]);
    return sum;
}

// In the polygon's plane, counter-clockwise.
std::vector<Eigen::Vector2d> flattened(const std::vector<Eigen::Vector3d>& corners, const Eigen::Vector3d& normal) {
    const Eigen::Vector3d u = normal.unitOrthogonal();
    const Eigen::Vector3d v = normal.cross(u);
    std::vector<Eigen::Vector2d> points;
    points.reserve(corners.size());
    for (const Eigen::Vector3d& corner : corners) {
        const Eigen::Vector3d offset = corner - corners[0];
        points.emplace_back(u.dot(offset), v.dot(offset));
    }
    return points;
}

// By how far corners may lie off their true places: they come from single precision.
double rounding_of(const std::vector<Eigen::Vector3d>& corners) {
    double largest = 0.0;
    for (const Eigen::Vector3d& corner : corners) largest = std::max(largest, corner.cwiseAbs().maxCoeff());
    return 2e-7 * largest;
}

// Cuts off one corner after the other.
class EarClipper {
  public:
    EarClipper(std::vector<Eigen::Vector2d> points, double rounding, std::int64_t& work)
        : points_(std::move(points)), rounding_(rounding), work_(work), left_(static_cast<int>(points_.size())) {
        for (int i = 0; i < left_; ++i) {
            before_.push_back(i == 0 ? left_ - 1 : i - 1);
            after_.push_back(i + 1 == left_ ? 0 : i + 1);
        }
    }

    // True if all triangles from corner 0 have area and are wound alike: the polygon is convex, or seen whole from it.
    bool is_fan() const {
        for (int k = 2; k < left_; ++k) {
            if (!has_area(0, k - 1, k)) return false;
        }
        return true;
    }

    Triangles run() {
        cut_spikes();
        int start = any_left_;
        while (left_ > 2) {
            const int ear = left_ == 3 ? start : next_ear(start);
            if (work_ <= 0) return {};
            cut_off(ear);
            // Not the next corner: cuts are to go round and not to make fans.
            start = after(after(ear));
        }
        return std::move(triangles_);
    }

  private:
    enum class Care {
        kAll,  // the cut keeps away from other corners: one upon it would lose the area of its own triangle
        kSome  // it may touch them
    };

    const Eigen::Vector2d& at(int i) const { return points_[static_cast<std::size_t>(i)]; }
    int before(int i) const { return before_[static_cast<std::size_t>(i)]; }
    int after(int i) const { return after_[static_cast<std::size_t>(i)]; }

    void cut_off(int ear) {
        triangles_.push_back({before(ear), ear, after(ear)});
        after_[static_cast<std::size_t>(before(ear))] = after(ear);
        before_[static_cast<std::size_t>(after(ear))] = before(ear);
        any_left_ = before(ear);
        --left_;
    }

    // Before anything else: beside one that points outwards there would seem to be an ear.
    void cut_spikes() {
        int b = any_left_;
        for (int seen = 0; seen < left_ && left_ > 3; ++seen) {
            if (is_spike(b)) {
                cut_off(b);
                // What stood before it may be the end of one now.
                b = before(before(b));
                seen = std::max(seen - 2, -1);
            }
            b = after(b);
        }
    }

    double twice_area(int a, int b, int c) const { return cross(at(b) - at(a), at(c) - at(a)); }

    // Counter-clockwise, and higher than rounding.
    bool has_area(int a, int b, int c) const {
        const double squared =
            std::max({(at(b) - at(a)).squaredNorm(), (at(c) - at(b)).squaredNorm(), (at(a) - at(c)).squaredNorm()});
        return twice_area(a, b, c) > rounding_ * std::sqrt(squared);
    }

    // Without area whatever the rest of the polygon is: the corner repeats its neighbour or is the end of a spike.
    bool is_spike(int b) const { return are_one(b, before(b)) || are_one(before(b), after(b)); }
    bool are_one(int a, int b) const { return (at(a) - at(b)).squaredNorm() <= rounding_ * rounding_; }

    int next_ear(int start) {
        for (const Care care : {Care::kAll, Care::kSome}) {
            int b = start;
            for (int k = 0; k < left_ && work_ > 0; ++k, b = after(b)) {
                if (is_spike(b) || is_ear(b, care)) return b;
            }
        }
        return smallest_corner(start);
    }

    // Where rounding or a polygon that crosses itself leaves no ear: the cut that errs least.
    int smallest_corner(int start) {
        work_ -= left_;
        int smallest = start;
        int b = start;
        for (int k = 0; k < left_; ++k, b = after(b)) {
            const auto size = [this](int i) { return std::abs(twice_area(before(i), i, after(i))); };
            if (size(b) < size(smallest)) smallest = b;
        }
        return smallest;
    }

    // An ear: the corner is convex, and no edge passes through its triangle. Then the triangle lies in the polygon,
    // also where corners coincide.
    bool is_ear(int b, Care care) {
        --work_;
        const int a = before(b);
        const int c = after(b);
        if (care == Care::kAll ? !has_area(a, b, c) : !(twice_area(a, b, c) > 0.0)) return false;
        const Inset inset(at(a), at(b), at(c), rounding_);
        for (int p = c; p != a; p = after(p)) {
            --work_;
            if (inset.is_met_by(at(p), at(after(p)))) return false;
            if (care == Care::kAll && lies_between(a, c, p)) return false;
        }
        return true;
    }

    // Up to rounding, and not at an end.
    bool lies_between(int a, int c, int p) const {
        const Eigen::Vector2d along = at(c) - at(a);
        const Eigen::Vector2d offset = at(p) - at(a);
        const double length = along.norm();
        const double place = along.dot(offset);
        return std::abs(cross(along, offset)) <= rounding_ * length && place > rounding_ * length &&
               place < (length - rounding_) * length;
    }

    // The inside of triangle abc, `margin` within its sides.
    class Inset {
      public:
        Inset(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, double margin)
            : sides_{side(a, b, margin), side(b, c, margin), side(c, a, margin)},
              low_(a.cwiseMin(b).cwiseMin(c).array() - margin),
              high_(a.cwiseMax(b).cwiseMax(c).array() + margin) {}

        bool is_met_by(const Eigen::Vector2d& p, const Eigen::Vector2d& q) const {
            if ((p.array() < low_.array() && q.array() < low_.array()).any()) return false;
            if ((p.array() > high_.array() && q.array() > high_.array()).any()) return false;
            // The part of the segment that lies within all three sides.
            double enter = 0.0;
            double leave = 1.0;
            for (const Side& side : sides_) {
                const double at_p = side.inward.dot(p) - side.offset;
                const double at_q = side.inward.dot(q) - side.offset;
                if (at_p <= 0.0 && at_q <= 0.0) return false;
                const double crossing = at_p / (at_p - at_q);
                if (at_p <= 0.0) enter = std::max(enter, crossing);
                if (at_q <= 0.0) leave = std::min(leave, crossing);
            }
            return enter < leave;
        }

      private:
        struct Side {
            Eigen::Vector2d inward;
            double offset;
        };
        static Side side(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double margin) {
            const Eigen::Vector2d along = (to - from).normalized();
            const Eigen::Vector2d inward(-along.y(), along.x());
            return {inward, inward.dot(from) + margin};
        }

        std::array<Side, 3> sides_;
        Eigen::Vector2d low_, high_;
    };

    std::vector<Eigen::Vector2d> points_;
    double rounding_;
    std::int64_t& work_;
    int left_;
    int any_left_ = 0;
    std::vector<int> before_, after_;  // among the corners that are left
    Triangles triangles_;
};

Triangles fan(std::size_t num_corners) {
    Triangles triangles;
    for (int k = 2; k < static_cast<int>(num_corners); ++k) triangles.push_back({0, k - 1, k});
    return triangles;
}

}  // namespace

Triangles triangulate(const std::vector<Eigen::Vector3d>& corners, std::int64_t& work) {
    const Eigen::Vector3d normal = normal_of(corners).stableNormalized();
    if (normal.isZero()) return fan(corners.size());
    EarClipper clipper(flattened(corners, normal), rounding_of(corners), work);
    return clipper.is_fan() ? fan(corners.size()) : clipper.run();
}

}  // namespace nearpose
