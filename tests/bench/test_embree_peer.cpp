// The peer, where it is built in: every way of asking it, against brute force.
#ifdef HR_HAS_EMBREE

#include "bench/peers/embree_peer.hpp"
#include "tests/bench/check_tracer.hpp"

namespace hemiray {

using namespace bench;

TEST_CASE("Embree answers as brute force does, in every quality and way of asking") {
  for (const EmbreeQuality quality : {EmbreeQuality::low, EmbreeQuality::medium, EmbreeQuality::high}) {
    for (const bool robust : {false, true}) {
      for (const EmbreeMode mode : {EmbreeMode::single, EmbreeMode::eight, EmbreeMode::sixteen, EmbreeMode::stream}) {
        const auto tracer = make_embree_peer({quality, robust, mode, 2});
        const auto sharer = make_embree_peer({quality, robust, EmbreeMode::single, 1});
        test::check_tracer(*tracer, *sharer);
      }
    }
  }
}

TEST_CASE("Embree's tracers are named by quality and way of asking, only the same trees are shared") {
  const auto medium = make_embree_peer({EmbreeQuality::medium, false, EmbreeMode::stream, 1});
  const auto robust = make_embree_peer({EmbreeQuality::medium, true, EmbreeMode::single, 1});
  CHECK(medium->name() == "embree/medium/stream");
  CHECK(medium->in_packets());
  CHECK(robust->name() == "embree/medium/robust/single");
  CHECK(robust->build_name() == "embree/medium/robust");
  CHECK_FALSE(robust->in_packets());
  medium->build(test::triangle_soup(20, 1));
  CHECK_FALSE(robust->share_build(*medium));
  CHECK_THROWS_AS(robust->intersect(), std::logic_error);
  CHECK_THAT(embree_version(), Catch::StartsWith("3."));
}

}  // namespace hemiray

#endif
