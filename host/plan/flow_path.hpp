// One point's way along the gradient of the distance, from event to event.
//
// State: the place x, the time t and the contacts: patches of the surface each of which has one nearest point, all equally
// far from x. The velocity v is the vector of least norm in the convex hull of the unit vectors n_i from the contacts to x.
//   1. Contacts farther than the nearest are dropped, those with the same nearest point joined.
//   2. One contact: a straight ray up to the radius R of the largest empty ball that touches there (shrinking ball); then
//      a second contact.
//   3. More: x slides with the contacts frozen: straight at constant speed while all nearest points stay inside their
//      triangles, else by Dormand and Prince with Newton steps back to equal distances.
//   4. A nearer triangle at the end of a step: the time of the tie is bracketed with the contacts unchanged, the step
//      shortened to it, and then the triangle is taken in: into a contact that has its nearest point there already (a
//      hand-over), else as a new one.
//
// A path stops wherever it needs the nearest triangle of a place, and goes on when it is told: whoever runs it answers one
// path after another or, in wavefronts, one query of each of many at once. The answers decide the bits, not who gives them.
#pragma once

#include "host/flow.hpp"
#include "host/plan/flow_steps.hpp"
#include "host/plan/flow_surface.hpp"

#include <array>

namespace cowgpu::plan {

/// What a path came to.
struct FlowEnd {
  Vec3 position = Vec3::Zero();
  double distance = 0;
  std::uint32_t face = 0;
  std::uint8_t flags = 0;
  double slide_time = std::numeric_limits<double>::infinity();
  Vec3 slide_place = Vec3::Zero();
  std::uint32_t queries = 0, events = 0, steps = 0;
};

/// A path between its first query's answer and the next one's: all there is to know of it.
struct FlowDeparture {
  enum class Asks { lift, ray, last } asks = Asks::last; ///< what the query is for
  Vec3 place = Vec3::Zero();
  double time = 0;
  Vec3 foot = Vec3::Zero(), normal = Vec3::Zero(); ///< foot and normal of the ball about the query, but for `last`
  double distance = 0, radius = 0;                 ///< distance of the place from the foot; radius of the ball
  std::uint32_t face = 0;                          ///< face of the foot
  bool inside = false;                             ///< it ended before it came out of the body
  std::uint32_t rounds = 0;
};

/// Corners of a path and their times, if asked for.
struct FlowTrace {
  std::vector<Vec3> places;
  std::vector<double> times;
};

class FlowPath {
public:
  FlowPath(const FlowSurface& surface, double time, double tolerance, FlowTrace* trace = nullptr);

  /// From a place, with `normal` zero, or from a surface point along its normal.
  void start(const Vec3& place, const Vec3& normal);

  bool done() const { return phase_ == Phase::done; }

  /// Until it is done: the place whose nearest face (FlowSurface::nearest) it waits for, and a face that may be near it or
  /// no_face.
  const Vec3& query() const { return query_; }
  std::uint32_t warm() const { return query_warm_; }

  /// Goes on to the next query or to the end.
  void answer(std::uint32_t face);

  /// It is done, however far it came.
  void stop() { phase_ = Phase::done; }

  const FlowEnd& end() const { return end_; }

  /// For whoever goes on with it elsewhere, after the first answer.
  FlowDeparture departure() const;

  /// Longest step of a slide, in distances from the surface, and the steps a path may take.
  static double longest_step(double tolerance);
  static double most_steps(double tolerance);

  /// What a time that has come may lack.
  static constexpr double time_digits = 1e-14;

private:
  static constexpr int most_contacts = 8, most_faces = 6;

  // Lengths relative to the body's diagonal. Next to the surface, where flows off edges start, they go with the distance.
  static constexpr double rounding = 1e-13;   ///< what two ways to the same length may differ by
  static constexpr double tie = 1e-11;        ///< a triangle nearer by so much is an event
  static constexpr double apart = 1e-9;       ///< a contact farther by so much is none
  static constexpr double off_surface = 1e-7; ///< where a flow starts that cannot leave along the normal
  static constexpr double digits = 4e-15;     ///< what doubles can tell
  static constexpr double same_point = 1e-6;  ///< relative to the distance instead
  static constexpr double near_share = 1e3;   ///< a length of 1e-3 diagonals and more is not next to the surface

  // Of what Eigen makes of vectors too; shaders/flow.comp does the same operations in the same order.
  static double norm(const Vec3& a) { return plan::norm<double>(a); }
  static double square(const Vec3& a) { return dot<double>(a, a); }

  /// What the query is for.
  enum class Phase { start, lift, restart, ray, slide, last, done };

  struct Contact {
    std::array<std::uint32_t, most_faces> faces{};
    int count = 0;
    void add(std::uint32_t face);
  };
  struct Contacts {
    std::array<Contact, most_contacts> list{};
    int count = 0;
    void add(std::uint32_t face);
  };
  /// Contacts as seen from a place.
  struct View {
    std::array<Vec3, most_contacts> normals, points;
    std::array<double, most_contacts> distances{}, weights{};
    std::array<std::uint32_t, most_contacts> faces{};
    std::array<bool, most_contacts> inside{};
    Vec3 place, velocity;
    double distance = 0; ///< the least
    int count = 0;
    bool active(int i) const { return weights[std::size_t(i)] > 1e-9; }
    double active_distance() const;
  };
  /// A ball that shrinks until it is empty.
  struct Ball {
    Vec3 foot, normal;
    double distance = 0;    ///< distance of x from the foot
    double radius = 0;      ///< radius of the ball; not less than distance in the end
    double limit = 0;       ///< radius at the end of time
    std::uint32_t face = 0; ///< face of the foot
    std::uint32_t hit = 0;  ///< nearest to the centre of the ball before
    Vec3 touched;           ///< its point
    int rounds = 0;
  };
  /// A step that has to be checked.
  struct Step {
    View from;
    Vec3 place;
    double step = 0, next = 0; ///< next: what its error allows for the one after it
    bool straight = false;
    std::uint32_t nearer = 0; ///< a face met on the way, or no_face
    int tries = 0;
  };

  double small(double length, double distance) const;
  void look(const Vec3& x, View& view) const;
  void tidy(View& view);
  void ask(Phase phase, const Vec3& place, std::uint32_t warm);
  void go_on(View* known = nullptr);
  void leave();
  void lift(std::uint32_t face);
  void begin_ray(const Vec3& foot, const Vec3& normal, double distance, std::uint32_t face);
  void shrink(std::uint32_t face);
  void end_ray();
  void begin_slide(const View& view);
  void check_slide(std::uint32_t face);
  void end_slide(View* view);
  void restart(std::uint32_t face);
  void take_in(std::uint32_t face, const Vec3& place);
  Vec3 advance(const View& from, double step, bool straight) const;
  Vec3 slide_step(const Vec3& from, const Vec3& velocity, double step, View& view, double* error) const;
  void balance(Vec3& x, View& view) const;
  bool straight(const View& from, const Vec3& to) const;
  double to_tie(const View& from, std::uint32_t face, double step, double gap, bool straight, Vec3& place);
  bool come_out(const Vec3& place, Vec3& foot, Vec3& normal, std::uint32_t& face) const;
  void record();

  const FlowSurface* surface_;
  double time_, tolerance_, scale_, longest_, most_steps_;
  FlowTrace* trace_;
  FlowEnd end_;
  Contacts contacts_;
  Vec3 x_;
  double t_ = 0, step_ = 0; ///< step_: what the error of the last slide allows; 0 if not known
  std::uint32_t warm_ = 0;
  bool inside_ = false; ///< it ended before it came out
  int idle_ = 0;        ///< steps in turn that came nowhere
  int rounds_ = 0;
  Phase phase_ = Phase::done;
  Vec3 query_;
  std::uint32_t query_warm_ = 0;
  Ball ball_;
  Step slide_;
};

} // namespace cowgpu::plan
