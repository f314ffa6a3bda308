// What a point on its way is, for flow.comp: its numbers, its contacts, how they are kept between two dispatches.
//
// Globals are not `precise`: glslang would make them variables of a function.

layout(binding = FLOW_FRAMES) uniform usamplerBuffer frames;
layout(std430, binding = FLOW_LANES) readonly buffer Lanes { uvec2 lanes[]; };
layout(std430, binding = FLOW_CANDIDATES) readonly buffer Candidates {
  uint total;
  uint candidates[];
};
layout(std430, binding = FLOW_FACES) readonly buffer Faces { uint face_of[]; };
layout(std430, binding = FLOW_ENTRIES) readonly buffer Entries { FlowEntry entries[]; };
layout(std430, binding = FLOW_NUMBERS) buffer Numbers { double numbers[]; };
layout(std430, binding = FLOW_WORDS) buffer Words { uint words[]; };
layout(std430, binding = FLOW_POINTS) buffer Points { FlowPoint points[]; };
layout(push_constant) uniform Push { FlowPush push; };

// Flags of host/flow.hpp.
const uint slid_flag = 1, stationary_flag = 2, unfinished_flag = 16, notch_flag = 64;

// Lengths relative to the diagonal, and the last to the distance, as in host/plan/flow_path.cpp.
const double rounding = 1e-13lf, tie = 1e-11lf, apart = 1e-9lf, off_surface = 1e-7lf, digits = 4e-15lf;
const double same_point = 1e-6lf, near_share = 1e3lf;

// What the view is for.
const uint for_last = 0, for_lift = 1, for_ray = 2, for_restart = 3, for_check = 4, for_contacts = 5, for_velocity = 6,
           for_line = 7, for_stage = 8, for_balance = 9, for_tie = 10, for_gap = 11, for_nearer = 12;

uint place;    // of the point
uint planned, done; // iterations of inner loops

// The point.
dvec3 x;
double recorded; // time of FLOW_RECORDED; x is its place
double t, carried; // carried: the step that the error of the last slide allows
uint flags, marks, idle, rounds, queries, events, steps;
uint count, counts; // contacts, and four bits each their faces
uint faces[FLOW_CONTACTS * FLOW_CONTACT_FACES];
dvec3 slide_place;
double slide_time;

// The ball of a ray.
dvec3 ball_foot, ball_normal, touched;
double ball_distance, radius, limit;
uint ball_face, hit, ball_rounds;

// The step of a slide and the search for a tie.
dvec3 slide_end, k1, k2, k3, k4, k5, k6;
double from_distance, step_length, next_step, most, tried, low, high, low_gap, high_gap;
uint nearer, ties, stage, tries, round_of_tie, round_of_balance;
int side;
bool line, in_tie;

// The query.
bool asking;
uint phase;
dvec3 asked;

// What is to be looked for, at which place, and a face to be looked at beside the contacts.
uint look_for, extra;
dvec3 at;

precise double dot3(dvec3 a, dvec3 b) {
  precise double sum = a.x * b.x + (a.y * b.y + a.z * b.z);
  return sum;
}
precise double norm3(dvec3 a) {
  precise double length = sqrt(dot3(a, a));
  return length;
}
double least(double a, double b) { return b < a ? b : a; }
double most_of(double a, double b) { return a < b ? b : a; }
double within(double a, double low, double high) { return a < low ? low : high < a ? high : a; }

precise double small(double length, double distance) {
  precise double near = near_share * distance;
  precise double some = length * least(push.scale, near), none = digits * push.scale;
  return most_of(none, some);
}
precise double longer(double allowed, double error) {
  precise double factor = 0.9lf * sqrt(sqrt(allowed / error));
  return factor;
}

uint faces_of(uint contact) { return counts >> (4 * contact) & 15; }
void set_faces(uint contact, uint n) { counts = (counts & ~(15u << (4 * contact))) | n << (4 * contact); }

// Every contact has one face.
bool single_faces() {
  const uint theirs = count == FLOW_CONTACTS ? 0xffffffffu : (1u << (4 * count)) - 1;
  return ((counts ^ 0x11111111u) & theirs) == 0;
}

// Puts a face into a contact.
void add_face(uint contact, uint face) {
  const uint i = FLOW_CONTACT_FACES * contact;
  uint n = faces_of(contact);
  if ((n > 0 && faces[i] == face) || (n > 1 && faces[i + 1] == face) || (n > 2 && faces[i + 2] == face) ||
      (n > 3 && faces[i + 3] == face) || (n > 4 && faces[i + 4] == face) || (n > 5 && faces[i + 5] == face))
    return;
  if (n == FLOW_CONTACT_FACES) { // the oldest goes
    faces[i] = faces[i + 1];
    faces[i + 1] = faces[i + 2];
    faces[i + 2] = faces[i + 3];
    faces[i + 3] = faces[i + 4];
    faces[i + 4] = faces[i + 5];
    --n;
  }
  faces[i + n] = face;
  set_faces(contact, n + 1);
}

void add_contact(uint face) {
  if (count == FLOW_CONTACTS) return;
  faces[FLOW_CONTACT_FACES * count] = face;
  set_faces(count, 1);
  ++count;
}

void ask(uint why, dvec3 where) {
  asking = true;
  phase = why;
  asked = where;
  ++queries;
}

precise dvec3 ball_centre() {
  precise dvec3 centre = ball_foot + radius * ball_normal;
  return centre;
}

void begin_ray(dvec3 foot, dvec3 normal, double distance, uint face) {
  ball_foot = foot;
  ball_normal = normal;
  ball_distance = distance;
  precise double left = push.time - t;
  precise double most_radius = distance + left;
  limit = most_radius;
  radius = most_radius;
  ball_face = face;
  hit = face;
  touched = foot;
  ball_rounds = 0;
  ask(FLOW_RAY, ball_centre());
}

void record() {
  marks |= FLOW_RECORDED;
  recorded = t;
}

// A step off two contacts of a face each is under way.
bool on_sheet() {
  return count == 2 && single_faces() &&
         (look_for == for_line || look_for == for_stage || look_for == for_balance || look_for == for_tie ||
          look_for == for_gap);
}

double load(uint number) { return numbers[number * push.capacity + place]; }
dvec3 load3(uint number) { return dvec3(load(number), load(number + 1), load(number + 2)); }
uint load_word(uint word) { return words[word * push.capacity + place]; }
void save(uint number, double value) { numbers[number * push.capacity + place] = value; }
void save3(uint number, dvec3 value) {
  save(number, value.x);
  save(number + 1, value.y);
  save(number + 2, value.z);
}
void save_word(uint word, uint value) { words[word * push.capacity + place] = value; }

void load_state() {
  x = load3(0);
  t = load(3);
  carried = load(4);
  slide_time = load(5);
  slide_place = load3(6);
  ball_foot = load3(9);
  ball_normal = load3(12);
  touched = load3(15);
  ball_distance = load(18);
  radius = load(19);
  limit = load(20);
  k1 = load3(21);
  from_distance = load(24);
  step_length = load(25);
  next_step = load(26);
  slide_end = load3(27);
  const uint word = load_word(0);
  phase = word & 15;
  look_for = word >> 4 & 15;
  line = (word >> 8 & 1) != 0;
  in_tie = (word >> 9 & 1) != 0;
  side = int(word >> 10 & 3) - 1;
  stage = word >> 12 & 15;
  tries = word >> 16 & 63;
  round_of_balance = word >> 22 & 3;
  round_of_tie = word >> 24 & 63;
  const uint more = load_word(1);
  flags = more & 255;
  marks = more >> 8 & 255;
  count = more >> 16 & 15;
  ties = more >> 20 & 15;
  idle = more >> 24;
  counts = load_word(2);
  rounds = load_word(3);
  queries = load_word(4);
  events = load_word(5);
  steps = load_word(6);
  ball_face = load_word(7);
  hit = load_word(8);
  ball_rounds = load_word(9);
  nearer = load_word(10);
  extra = load_word(11);
  uint c = 0, k = 0;
  while (c < count) {
    faces[FLOW_CONTACT_FACES * c + k] = load_word(FLOW_STATE_FACES + FLOW_CONTACT_FACES * c + k);
    if (++k == faces_of(c)) {
      ++c;
      k = 0;
    }
  }
  if (c < count) ++planned; // cut short
}

void load_turn() {
  at = load3(30);
  k2 = load3(33);
  k3 = load3(36);
  k4 = load3(39);
  k5 = load3(42);
  k6 = load3(45);
  most = load(48);
  tried = load(49);
  low = load(50);
  high = load(51);
  low_gap = load(52);
  high_gap = load(53);
}

void save_state(bool busy) {
  save3(0, x);
  save(3, t);
  save(4, carried);
  save(5, slide_time);
  save3(6, slide_place);
  if (busy || phase != FLOW_SLIDE) {
    save3(9, ball_foot);
    save3(12, ball_normal);
    save3(15, touched);
    save(18, ball_distance);
    save(19, radius);
    save(20, limit);
  }
  if (busy || phase == FLOW_SLIDE) {
    save3(21, k1);
    save(24, from_distance);
    save(25, step_length);
    save(26, next_step);
    save3(27, slide_end);
  }
  save_word(0, phase | look_for << 4 | uint(line) << 8 | uint(in_tie) << 9 | uint(side + 1) << 10 | stage << 12 |
                   tries << 16 | round_of_balance << 22 | round_of_tie << 24);
  save_word(1, flags | (marks & 255) << 8 | count << 16 | ties << 20 | idle << 24);
  save_word(2, counts);
  save_word(3, rounds);
  save_word(4, queries);
  save_word(5, events);
  save_word(6, steps);
  save_word(7, ball_face);
  save_word(8, hit);
  save_word(9, ball_rounds);
  save_word(10, nearer);
  save_word(11, extra);
  uint c = 0, k = 0;
  while (c < count) {
    save_word(FLOW_STATE_FACES + FLOW_CONTACT_FACES * c + k, faces[FLOW_CONTACT_FACES * c + k]);
    if (++k == faces_of(c)) {
      ++c;
      k = 0;
    }
  }
  if (c < count) ++planned; // cut short
  if (!busy) return;
  save3(30, at);
  save3(33, k2);
  save3(36, k3);
  save3(39, k4);
  save3(42, k5);
  save3(45, k6);
  save(48, most);
  save(49, tried);
  save(50, low);
  save(51, high);
  save(52, low_gap);
  save(53, high_gap);
}

dvec3 vector_of(double v[3]) { return dvec3(v[0], v[1], v[2]); }

void depart() {
  x = vector_of(points[place].place);
  t = points[place].time;
  carried = 0;
  ball_foot = vector_of(points[place].foot);
  ball_normal = vector_of(points[place].normal);
  touched = ball_foot;
  ball_distance = points[place].distance;
  radius = points[place].radius;
  limit = radius;
  phase = points[place].phase;
  ball_face = points[place].face;
  hit = ball_face;
  ball_rounds = 0;
  flags = points[place].flags;
  marks = points[place].marks;
  rounds = points[place].rounds;
  queries = points[place].queries;
  events = points[place].events;
  steps = points[place].steps;
  idle = 0;
  count = 0;
  counts = 0;
}
