"""Set expressions from boundaries: from vertices, edges and faces to a Boolean expression of half-spaces.

The inverse problem of analytic geometry for solids given by their boundary (Shapiro, Acta Numerica 16
(2007), section 5; Shapiro and Vossler, Separation for boundary to CSG conversion, ACM Trans. Graphics 12
(1993), 35-55): polygons with holes, outlines of lines and circular arcs, polyhedra.
"""
