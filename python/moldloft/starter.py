"""The starter model of ``moldloft new``."""

STARTER = """\
# {name}: half of a small boat, from stem (x = 0) to transom; the keel lies in y = 0.
# Try:  moldloft build {file} --set beam=1.4 --to stl png
Model info(symmetry = "y", units = "m t");

param float length = 4.0 in [2, 8];
param float beam = 1.2 in [0.8, 2];

# Three master curves, each from the sheer down to the keel.
AbsPoint stem1(0, 0, 0.60);
AbsPoint stem2(0.04 * length, 0, 0.10);
AbsPoint stem3(0.10 * length, 0, -0.20);
BCurve stem({{stem1, stem2, stem3}}, degree = 2);

AbsPoint mid1(0.5 * length, 0.5 * beam, 0.45);
AbsPoint mid2(0.5 * length, 0.5 * beam, -0.20);
AbsPoint mid3(0.5 * length, 0, -0.30);
BCurve mid({{mid1, mid2, mid3}}, degree = 2);

AbsPoint transom1(length, 0.4 * beam, 0.50);
AbsPoint transom2(length, 0.4 * beam, -0.05);
AbsPoint transom3(length, 0, -0.10);
BCurve transom({{transom1, transom2, transom3}}, degree = 2);

# The hull is lofted through them; the stern closes it, and shares the transom's vertices.
CLoftSurf hull({{stem, mid, transom}}, divisions = {{12, 24}});
AbsPoint post1(length, 0, 0.50);
Line post(post1, transom3);
RuledSurf stern(transom, post, divisions = {{12, 6}});
"""

BOX = """\
# A box 10 x 4 x 2.5 about the origin.
AbsPoint a(-5, -2, -1); AbsPoint b(5, -2, -1); AbsPoint c(-5, 2, -1); AbsPoint d(5, 2, -1);
AbsPoint e(-5, -2, 1.5); AbsPoint f(5, -2, 1.5); AbsPoint g(-5, 2, 1.5); AbsPoint h(5, 2, 1.5);
Line ab(a, b); Line cd(c, d); Line ef(e, f); Line gh(g, h);
Line ac(a, c); Line eg(e, g); Line bd(b, d); Line fh(f, h);
RuledSurf bottom(ab, cd, orientation = 1);
RuledSurf top(ef, gh);
RuledSurf port(ab, ef);
RuledSurf starboard(cd, gh, orientation = 1);
RuledSurf bow(ac, eg, orientation = 1);
RuledSurf stern(bd, fh);
"""
"""A box for examples."""
