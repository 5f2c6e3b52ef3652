// Implements the arithmetic of the narrow phase once, as a template over a type L of lanes: a Highway vector,
// or one float for the tests. In: the corners of two triangles. Out: the area of their overlap and which is
// in front. It uses only + - * / sqrt and comparisons, and no fused multiply-add, so that every target
// computes the same bits.
//
// pair_test.cpp includes it inside a namespace once for each instruction set, so that the compiler builds it
// for that set. Therefore it has no include guard. L provides the types V (values) and M (masks) and the
// operations used below.

namespace pair_test {

template <class V>
struct Corners {
  V x[3], y[3];
};

template <class V>
struct Plane {
  V height, slope_x, slope_y;
};

// functions[i][j]: edge function of one triangle's edge i at the other's corner j; >= 0 inside.
template <class V>
struct EdgeFunctions {
  V f[3][3];
};

// The overlap as far as it has been computed.
template <class V>
struct Overlap {
  V doubled_area, lowest, highest;
};

template <class L>
EdgeFunctions<typename L::V> edge_functions(const Corners<typename L::V>& edges,
                                            const Corners<typename L::V>& points) {
  using V = typename L::V;
  EdgeFunctions<V> e;
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3;
    const V dx = L::sub(edges.x[k], edges.x[i]);
    const V dy = L::sub(edges.y[k], edges.y[i]);
    for (int j = 0; j < 3; ++j) {
      // Exactly 0 where the point is a corner of the edge: both products are then the same two factors.
      e.f[i][j] =
          L::sub(L::mul(dx, L::sub(points.y[j], edges.y[i])), L::mul(dy, L::sub(points.x[j], edges.x[i])));
    }
  }
  return e;
}

// Returns the lanes in which the other triangle is outside some edge of `edges`, or inside by less than
// `tolerance`.
template <class L>
typename L::M apart(const Corners<typename L::V>& edges, const EdgeFunctions<typename L::V>& e,
                    typename L::V tolerance) {
  using V = typename L::V;
  typename L::M result = L::none();
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3;
    const V dx = L::sub(edges.x[k], edges.x[i]);
    const V dy = L::sub(edges.y[k], edges.y[i]);
    const V edge_length = L::sqrt(L::add(L::mul(dx, dx), L::mul(dy, dy)));
    const V deepest = L::max(L::max(e.f[i][0], e.f[i][1]), e.f[i][2]);
    result = L::either(result, L::less_equal(deepest, L::mul(tolerance, edge_length)));
  }
  return result;
}

// Adds the pieces of the edges of `own` that lie inside the other triangle. `e`: the edge functions of the
// other triangle at the corners of `own`. Where two edges coincide, only the triangle with `closed` adds the
// piece, so that it counts once.
template <class L, bool closed>
void add_boundary(const Corners<typename L::V>& own, const EdgeFunctions<typename L::V>& e,
                  const Plane<typename L::V>& difference, Overlap<typename L::V>& overlap) {
  using V = typename L::V;
  const V zero = L::set(0.0F);
  const V one = L::set(1.0F);
  for (int j = 0; j < 3; ++j) {
    const int k = (j + 1) % 3;
    V enter = zero;
    V leave = one;
    for (int i = 0; i < 3; ++i) {
      const V f0 = e.f[i][j];
      const V f1 = e.f[i][k];
      const V t = L::div(f0, L::sub(f0, f1));
      enter = L::select(L::less(f0, zero), L::max(enter, t), enter);
      leave = L::select(L::less(f1, zero), L::min(leave, t), leave);
      if constexpr (!closed) {
        leave = L::select(L::both(L::less_equal(f0, zero), L::less_equal(f1, zero)), zero, leave);
      }
    }
    const auto inside = L::less(enter, leave);
    const V dx = L::sub(own.x[k], own.x[j]);
    const V dy = L::sub(own.y[k], own.y[j]);
    const V x0 = L::add(own.x[j], L::mul(enter, dx));
    const V y0 = L::add(own.y[j], L::mul(enter, dy));
    const V x1 = L::add(own.x[j], L::mul(leave, dx));
    const V y1 = L::add(own.y[j], L::mul(leave, dy));
    const V piece = L::sub(L::mul(x0, y1), L::mul(y0, x1));
    overlap.doubled_area = L::add(overlap.doubled_area, L::select(inside, piece, zero));

    const V d0 =
        L::add(difference.height, L::add(L::mul(difference.slope_x, x0), L::mul(difference.slope_y, y0)));
    const V d1 =
        L::add(difference.height, L::add(L::mul(difference.slope_x, x1), L::mul(difference.slope_y, y1)));
    overlap.lowest = L::select(inside, L::min(overlap.lowest, L::min(d0, d1)), overlap.lowest);
    overlap.highest = L::select(inside, L::max(overlap.highest, L::max(d0, d1)), overlap.highest);
  }
}

template <class L>
struct Verdict {
  typename L::M a_in_front, b_in_front, doubtful;
  typename L::V area;
};

// Bound of the rounding errors of a height difference: coordinates of size about 1 rounded to single
// precision, magnified by the slopes, and the few operations that follow, on numbers of the size of the
// triangles.
inline constexpr float kRounding = 2e-7F;
// An overlap smaller than this share of its square extent may be rounding noise of the boundary sum:
// doubtful.
inline constexpr float kAreaNoise = 1e-6F;

// Corners of both triangles are relative to A's first corner, which keeps rounding errors small.
template <class L>
Verdict<L> decide(const Corners<typename L::V>& a, const Plane<typename L::V>& plane_a,
                  const Corners<typename L::V>& b, const Plane<typename L::V>& plane_b,
                  typename L::V tolerance) {
  using V = typename L::V;
  const V zero = L::set(0.0F);
  const EdgeFunctions<V> b_in_a = edge_functions<L>(a, b);
  const EdgeFunctions<V> a_in_b = edge_functions<L>(b, a);
  const auto separated = L::either(apart<L>(a, b_in_a, tolerance), apart<L>(b, a_in_b, tolerance));

  V extent = zero;
  for (int i = 0; i < 3; ++i) {
    extent = L::max(extent,
                    L::max(L::max(L::abs(a.x[i]), L::abs(a.y[i])), L::max(L::abs(b.x[i]), L::abs(b.y[i]))));
  }

  // Height of A minus height of B as a plane over the common origin, A's first corner.
  const V height_b =
      L::sub(plane_b.height, L::add(L::mul(plane_b.slope_x, b.x[0]), L::mul(plane_b.slope_y, b.y[0])));
  const Plane<V> difference{L::sub(plane_a.height, height_b), L::sub(plane_a.slope_x, plane_b.slope_x),
                            L::sub(plane_a.slope_y, plane_b.slope_y)};
  const V slopes = L::add(L::add(L::abs(plane_a.slope_x), L::abs(plane_a.slope_y)),
                          L::add(L::abs(plane_b.slope_x), L::abs(plane_b.slope_y)));
  const V error =
      L::mul(L::set(kRounding),
             L::add(L::set(2.0F), L::mul(slopes, L::add(L::set(1.0F), L::mul(L::set(2.0F), extent)))));

  constexpr float kHuge = 3e38F;
  Overlap<V> overlap{zero, L::set(kHuge), L::set(-kHuge)};
  add_boundary<L, true>(a, a_in_b, difference, overlap);
  add_boundary<L, false>(b, b_in_a, difference, overlap);

  const auto covered =
      L::both(L::negate(separated),
              L::less(L::mul(L::set(kAreaNoise), L::mul(extent, extent)), overlap.doubled_area));
  const auto a_nearer = L::less(error, overlap.highest);
  const auto b_nearer = L::less(overlap.lowest, L::sub(zero, error));
  Verdict<L> verdict;
  verdict.area = L::mul(L::set(0.5F), overlap.doubled_area);
  verdict.a_in_front = L::both(covered, L::both(a_nearer, L::negate(b_nearer)));
  verdict.b_in_front = L::both(covered, L::both(b_nearer, L::negate(a_nearer)));
  verdict.doubtful =
      L::both(L::negate(separated), L::negate(L::either(verdict.a_in_front, verdict.b_in_front)));
  return verdict;
}

}  // namespace pair_test
