!> Where two convex polyhedra touch or nearly do: the corners of the polygon that their faces share, as pairs of
!> features that keep their meaning while the bodies move a little; or, where edges cross, these edges.
!>
!> The face along whose normal the bodies overlap least is the reference; the other body's face that looks against it
!> is cut to the reference's outline. A corner of that polygon is a corner of one body over the plane of the other's
!> face, or a place where an edge of one crosses an edge of the other; where these are nearly parallel it is taken as a
!> point of the face that was cut. The gap of such a pair of features changes by the velocity of one body relative to
!> the other at that place alone, so that its spring is conservative.
!> Each corner carries what of the polygon lies nearer to it, seen from its centroid: of a rectangle a quarter, so that
!> a plane problem drawn out has the points of the plane, twice.
module dem3_patch
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use dem3_bodies, only : body, body_set, cross, most_corners
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: feature, patch, most_points, find_features, measure_feature

   integer, parameter :: most_points = 2 * most_corners   !! of what two convex faces share
   integer, parameter, public :: on_first = 1     !! a point of the second body over a plane of the first
   integer, parameter, public :: on_second = 2    !! a point of the first body over a plane of the second
   integer, parameter, public :: on_edges = 3     !! an edge of each

   !> Of the size of the lesser part: faces that overlap deeper are searched for edges that cross
   real(wp), parameter :: deep = 2.0e-3_wp
   !> Of the same: side of the square that a point where edges cross stands for
   real(wp), parameter :: edge_side = 0.05_wp
   !> Of the same: corners nearer than this are one
   real(wp), parameter :: same = 1.0e-3_wp
   !> Of the same: as reference the face of before is kept unless another is better by this
   real(wp), parameter :: better = 1.0e-3_wp
   !> Of the lesser face: the corners of a smaller polygon carry as much as those of this
   real(wp), parameter :: sliver = 0.1_wp
   !> Cosine between the normals of faces that look against each other, at least, if corners of both are to count
   real(wp), parameter :: facing_enough = 0.9_wp

   !> What touches: own in the frame of the body whose point it is. On edges, own and along are those of the first
   !> body's edge, normal and other of the second's (start, direction; each in its body's frame).
   type :: feature
      integer :: kind = 0
      real(wp) :: own(3) = 0.0_wp                !! [m]
      real(wp) :: normal(3) = 0.0_wp             !! outward, of the plane, in its body's frame
      real(wp) :: level = 0.0_wp                 !! of the plane along it [m]; on edges: sense of the axis
      real(wp) :: along(3) = 0.0_wp              !! on edges
      real(wp) :: other(3) = 0.0_wp              !! on edges
      real(wp) :: area = 0.0_wp                  !! that it carries [m^2]
      real(wp) :: at(3) = 0.0_wp                 !! where it was found, in the frame of the first body [m]
   end type feature

   type :: patch
      integer :: points = 0
      integer :: reference = 0                   !! 1 or 2: whose face is the reference
      type(feature) :: point(most_points)
   end type patch

contains

   !> Features of parts one and two that are nearer than a margin
   pure subroutine find_features(set, one, two, margin, whole, before, found, status)
      type(body_set), intent(in) :: set
      integer, intent(in) :: one
      integer, intent(in) :: two
      real(wp), intent(in) :: margin             !! [m]
      logical, intent(in) :: whole               !! of faces that touch also the corners that are farther apart
      integer, intent(in) :: before              !! reference of before, 0 none
      type(patch), intent(out) :: found
      integer(c_int), intent(out) :: status      !! status_out_of_memory, else ok
      real(wp), allocatable :: here_one(:, :), here_two(:, :)
      real(wp) :: least_one, least_two, size, handicap, facing_cosine
      integer :: face_one, face_two, facing, failed

      allocate (here_one(3, set%parts(one)%vertex_last - set%parts(one)%vertex_first + 1), &
         here_two(3, set%parts(two)%vertex_last - set%parts(two)%vertex_first + 1), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      associate (a => set%item(set%parts(one)%owner), b => set%item(set%parts(two)%owner))
         call in_space(set, one, a, here_one)
         call in_space(set, two, b, here_two)
         size = min(set%parts(one)%size, set%parts(two)%size)
         call least_overlap(set, one, a, here_two, margin, least_one, face_one)
         if (least_one > margin) return
         call least_overlap(set, two, b, here_one, margin, least_two, face_two)
         if (least_two > margin) return
         handicap = 0.0_wp
         if (before == 1) handicap = better * size
         if (before == 2) handicap = -better * size
         found%reference = merge(1, 2, least_one + handicap >= least_two - 1.0e-9_wp * size)
         if (found%reference == 1) then
            call look_back(set, face_one, a, two, b, facing, facing_cosine)
         else
            call look_back(set, face_two, b, one, a, facing, facing_cosine)
         end if
         ! Corners beyond the outline of a face may lie deep below its plane: of faces that look against each other the
         ! polygon gives the points in contact.
         if (max(least_one, least_two) < -deep * size .and. facing_cosine > -facing_enough) then
            call find_edges(set, one, two, here_one, here_two, max(least_one, least_two), margin, size, found)
            if (found%points >= 0) found%reference = 0
            if (found%points >= 0) return
            found%points = 0
         end if
         if (found%reference == 1) then
            call clip_shared_face(set, one, face_one, here_one, a, two, facing, facing_cosine, here_two, b, &
               on_first, size, &
               merge(huge(1.0_wp), margin, whole), found)
         else
            call clip_shared_face(set, two, face_two, here_two, b, one, facing, facing_cosine, here_one, a, &
               on_second, size, &
               merge(huge(1.0_wp), margin, whole), found)
         end if
      end associate
   end subroutine find_features

   !> Normal from the first body to the second, gap and place of a feature in space
   pure subroutine measure_feature(one, a, b, normal, gap, at)
      type(feature), intent(in) :: one
      type(body), intent(in) :: a                !! the first
      type(body), intent(in) :: b                !! the second
      real(wp), intent(out) :: normal(3)
      real(wp), intent(out) :: gap               !! negative where they overlap [m]
      real(wp), intent(out) :: at(3)             !! [m]
      real(wp) :: u(3), v(3), from(3), to(3), uu, uv, vv, s, t, length
      select case (one%kind)
      case (on_first)
         at = b%x + matmul(b%turn, one%own)
         normal = matmul(a%turn, one%normal)
         gap = dot_product(normal, at - a%x) - one%level
      case (on_second)
         at = a%x + matmul(a%turn, one%own)
         normal = -matmul(b%turn, one%normal)
         gap = dot_product(normal, b%x - at) - one%level
      case default
         from = a%x + matmul(a%turn, one%own)
         u = matmul(a%turn, one%along)
         to = b%x + matmul(b%turn, one%normal)
         v = matmul(b%turn, one%other)
         normal = cross(u, v)
         length = norm2(normal)
         uu = dot_product(u, u)
         vv = dot_product(v, v)
         uv = dot_product(u, v)
         gap = 1.0_wp
         at = from
         if (length <= 1.0e-3_wp * sqrt(uu * vv)) return   ! they do not cross any more
         normal = one%level * normal / length
         s = (vv * dot_product(u, to - from) - uv * dot_product(v, to - from)) / (uu * vv - uv**2)
         t = (uv * dot_product(u, to - from) - uu * dot_product(v, to - from)) / (uu * vv - uv**2)
         gap = dot_product(normal, to - from)
         at = 0.5_wp * (from + s * u + to + t * v)
      end select
   end subroutine measure_feature

   !> Vertices of a part in space
   pure subroutine in_space(set, part, b, here)
      type(body_set), intent(in) :: set
      integer, intent(in) :: part
      type(body), intent(in) :: b
      real(wp), intent(out) :: here(:, :)        !! (3, its vertices) [m]
      integer :: k
      do k = 1, size(here, 2)
         here(:, k) = b%x + matmul(b%turn, set%vertex(:, set%parts(part)%vertex_first + k - 1))
      end do
   end subroutine in_space

   !> The face of a part along whose normal the vertices of another overlap it least: that overlap, negative, or a gap
   pure subroutine least_overlap(set, part, b, other, margin, least, face)
      type(body_set), intent(in) :: set
      integer, intent(in) :: part
      type(body), intent(in) :: b                !! its owner
      real(wp), intent(in) :: other(:, :)        !! vertices of the other in space [m]
      real(wp), intent(in) :: margin             !! a gap beyond it ends the search [m]
      real(wp), intent(out) :: least
      integer, intent(out) :: face
      real(wp) :: normal(3), depth, level
      integer :: f, k
      least = -huge(1.0_wp)
      face = set%parts(part)%face_first
      do f = set%parts(part)%face_first, set%parts(part)%face_last
         normal = matmul(b%turn, set%normal(:, f))
         level = set%level(f) + dot_product(normal, b%x)
         depth = huge(1.0_wp)
         do k = 1, size(other, 2)
            depth = min(depth, dot_product(normal, other(:, k)) - level)
            if (depth <= least) exit
         end do
         if (depth > least) then
            least = depth
            face = f
            if (least > margin) return
         end if
      end do
   end subroutine least_overlap

   !> The face of another part that looks most against a face, and the cosine between their normals
   pure subroutine look_back(set, face, a, other, b, facing, facing_cosine)
      type(body_set), intent(in) :: set
      integer, intent(in) :: face
      type(body), intent(in) :: a                !! its owner
      integer, intent(in) :: other
      type(body), intent(in) :: b                !! owner of the other
      integer, intent(out) :: facing
      real(wp), intent(out) :: facing_cosine
      real(wp) :: normal(3), cosine
      integer :: f
      normal = matmul(a%turn, set%normal(:, face))
      facing_cosine = huge(1.0_wp)
      facing = set%parts(other)%face_first
      do f = set%parts(other)%face_first, set%parts(other)%face_last
         cosine = dot_product(normal, matmul(b%turn, set%normal(:, f)))
         if (cosine < facing_cosine) then
            facing_cosine = cosine
            facing = f
         end if
      end do
   end subroutine look_back

   !> The polygon that the reference face shares with the face of the other part that looks against it
   pure subroutine clip_shared_face(set, part, face, corners, a, other, facing, facing_cosine, corners_other, b, &
      kind, size, &
                         margin, found)
      type(body_set), intent(in) :: set
      integer, intent(in) :: part                !! of the reference face
      integer, intent(in) :: face
      real(wp), intent(in) :: corners(:, :)      !! its vertices in space [m]
      type(body), intent(in) :: a                !! its owner
      integer, intent(in) :: other
      integer, intent(in) :: facing              !! the face of the other, see look_back
      real(wp), intent(in) :: facing_cosine
      real(wp), intent(in) :: corners_other(:, :)
      type(body), intent(in) :: b
      integer, intent(in) :: kind                !! of a point of the other over the reference
      real(wp), intent(in) :: size               !! of the lesser part [m]
      real(wp), intent(in) :: margin             !! of corners that count [m]
      type(patch), intent(inout) :: found
      real(wp) :: normal(3), against(3), inward(3), start(3), along(3), kept(3, most_points), next(3, most_points)
      real(wp) :: side(most_points), area(most_points), level, gap, limit
      !> Of each corner the line on which the outline arrives at it, and the two that cross there: above 0 an edge of
      !> the other face, below 0 one of the reference
      integer :: lines(3, most_points), next_lines(3, most_points)
      integer :: k, n, m, i, j, shift, shift_other
      logical :: crossing

      shift = set%parts(part)%vertex_first - 1
      shift_other = set%parts(other)%vertex_first - 1
      normal = matmul(a%turn, set%normal(:, face))
      level = set%level(face) + dot_product(normal, a%x)
      n = 0
      do k = set%loop_first(facing), set%loop_first(facing + 1) - 1
         n = n + 1
         kept(:, n) = corners_other(:, set%loop(k) - shift_other)
         lines(:, n) = [merge(set%loop_first(facing + 1) - 1, k - 1, n == 1), 0, 0]
      end do
      do k = set%loop_first(face), set%loop_first(face + 1) - 1
         start = corners(:, set%loop(k) - shift)
         j = merge(set%loop_first(face), k + 1, k == set%loop_first(face + 1) - 1)
         along = corners(:, set%loop(j) - shift) - start
         inward = cross(normal, along)
         inward = inward / norm2(inward)
         do i = 1, n
            side(i) = dot_product(inward, kept(:, i) - start)
         end do
         m = 0
         do i = 1, n
            j = merge(n, i - 1, i == 1)
            if (side(i) * side(j) < 0.0_wp .and. m < most_points) then
               m = m + 1
               next(:, m) = kept(:, j) + side(j) / (side(j) - side(i)) * (kept(:, i) - kept(:, j))
               next_lines(:, m) = [merge(lines(1, i), -k, side(i) < 0.0_wp), lines(1, i), -k]
            end if
            if (side(i) >= 0.0_wp .and. m < most_points) then
               m = m + 1
               next(:, m) = kept(:, i)
               next_lines(:, m) = lines(:, i)
            end if
         end do
         n = m
         kept(:, :n) = next(:, :n)
         lines(:, :n) = next_lines(:, :n)
         if (n < 3) return
      end do
      limit = same * size
      m = 0
      do i = 1, n
         if (m > 0) then
            if (norm2(kept(:, i) - kept(:, m)) < limit) cycle
            if (i == n .and. norm2(kept(:, i) - kept(:, 1)) < limit) cycle
         end if
         m = m + 1
         kept(:, m) = kept(:, i)
         lines(:, m) = lines(:, i)
      end do
      if (m < 3) return
      n = m
      call share_area(normal, sliver * min(set%area(face), set%area(facing)), kept(:, :n), area(:n))
      against = matmul(b%turn, set%normal(:, facing))
      do i = 1, n
         gap = dot_product(normal, kept(:, i)) - level
         if (gap > margin) cycle
         found%points = found%points + 1
         associate (point => found%point(found%points))
            point%area = area(i)
            point%kind = kind
            point%normal = set%normal(:, face)
            point%level = set%level(face)
            point%own = matmul(kept(:, i) - b%x, b%turn)
            k = closest(kept(:, i), corners_other, set%loop(set%loop_first(facing):set%loop_first(facing + 1) - 1), &
               shift_other, limit, [0.0_wp, 0.0_wp, 0.0_wp])
            crossing = k == 0 .and. lines(2, i) > 0 .and. lines(3, i) < 0
            if (k > 0) then                       ! a corner of the other
               point%own = set%vertex(:, k)
            else if (facing_cosine < -facing_enough) then
               k = closest(kept(:, i), corners, set%loop(set%loop_first(face):set%loop_first(face + 1) - 1), shift, &
                  limit, normal)
               if (k > 0) then                    ! a corner of the reference, over the plane of the other
                  point%kind = on_first + on_second - kind
                  point%normal = set%normal(:, facing)
                  point%level = set%level(facing)
                  point%own = set%vertex(:, k)
                  crossing = .false.
               end if
            end if
            if (crossing) call cross_edges(set, edge_of(set, face, -lines(3, i)), edge_of(set, facing, lines(2, i)), &
               kind == on_first, normal, a, b, point)
            if (kind == on_first) then
               point%at = matmul(kept(:, i) - a%x, a%turn)
            else
               point%at = matmul(kept(:, i) - b%x, b%turn)
            end if
         end associate
      end do
   end subroutine clip_shared_face

   !> Vertices of the edge of a face that begins at a place of the list of loops
   pure function edge_of(set, face, place) result(ends)
      type(body_set), intent(in) :: set
      integer, intent(in) :: face
      integer, intent(in) :: place
      integer :: ends(2)
      ends = [set%loop(place), set%loop(merge(set%loop_first(face), place + 1, place == set%loop_first(face + 1) - 1))]
   end function edge_of

   !> A corner where an edge of the reference crosses one of the other face: these edges, if they are not parallel
   pure subroutine cross_edges(set, edge, edge_other, first, normal, a, b, point)
      type(body_set), intent(in) :: set
      integer, intent(in) :: edge(2)             !! its vertices, of the reference
      integer, intent(in) :: edge_other(2)
      logical, intent(in) :: first               !! the reference is of the first body
      real(wp), intent(in) :: normal(3)          !! of the reference, outward, in space
      type(body), intent(in) :: a                !! of the reference
      type(body), intent(in) :: b
      type(feature), intent(inout) :: point
      real(wp), parameter :: sharp = 0.2_wp      !! sine of the angle between them
      real(wp) :: u(3), v(3), axis(3)
      u = set%vertex(:, edge(2)) - set%vertex(:, edge(1))
      v = set%vertex(:, edge_other(2)) - set%vertex(:, edge_other(1))
      axis = cross(matmul(a%turn, u), matmul(b%turn, v))
      if (norm2(axis) < sharp * norm2(u) * norm2(v)) return
      point%kind = on_edges
      if (first) then
         point%own = set%vertex(:, edge(1))
         point%along = u
         point%normal = set%vertex(:, edge_other(1))
         point%other = v
         point%level = sign(1.0_wp, dot_product(axis, normal))
      else                                       ! the axis of first and second, from the first to the second
         point%own = set%vertex(:, edge_other(1))
         point%along = v
         point%normal = set%vertex(:, edge(1))
         point%other = u
         point%level = sign(1.0_wp, dot_product(axis, normal))
      end if
   end subroutine cross_edges

   !> The vertex of a list that is nearest to a place, within a limit and but for what lies along a direction; 0 none
   pure function closest(at, corners, list, shift, limit, along) result(found)
      real(wp), intent(in) :: at(3)
      real(wp), intent(in) :: corners(:, :)
      integer, intent(in) :: list(:)
      integer, intent(in) :: shift               !! number of the vertex before the first of the corners
      real(wp), intent(in) :: limit              !! [m]
      real(wp), intent(in) :: along(3)           !! unit, or nought
      integer :: found
      real(wp) :: away(3), best
      integer :: k
      found = 0
      best = limit
      do k = 1, size(list)
         away = corners(:, list(k) - shift) - at
         away = away - dot_product(away, along) * along
         if (norm2(away) >= best) cycle
         best = norm2(away)
         found = list(k)
      end do
   end function closest

   !> What each corner carries of a polygon, together no less than a least area
   pure subroutine share_area(normal, least, corner, area)
      real(wp), intent(in) :: normal(3)
      real(wp), intent(in) :: least              !! [m^2]
      real(wp), intent(in) :: corner(:, :)       !! (3, n) [m]
      real(wp), intent(out) :: area(:)           !! (n) [m^2]
      real(wp) :: middle(3), piece, total
      integer :: i, j, n
      n = size(area)
      area = 0.0_wp
      middle = centre(normal, corner)
      do i = 1, n
         j = merge(1, i + 1, i == n)
         piece = 0.5_wp * abs(dot_product(normal, cross(corner(:, i) - middle, corner(:, j) - middle)))
         area(i) = area(i) + 0.5_wp * piece
         area(j) = area(j) + 0.5_wp * piece
      end do
      total = sum(area)
      if (total < least) area = area + (least - total) / n
   end subroutine share_area

   !> Centroid of the area of a polygon. The mean of its corners would jump where a corner parts in two that lie
   !> together, and with it what all of them carry.
   pure function centre(normal, corner) result(middle)
      real(wp), intent(in) :: normal(3)
      real(wp), intent(in) :: corner(:, :)       !! (3, n) [m]
      real(wp) :: middle(3)
      real(wp) :: mean(3), one(3), next(3), piece, total
      integer :: i, n
      n = size(corner, 2)
      mean = sum(corner, dim=2) / n
      middle = 0.0_wp
      total = 0.0_wp
      do i = 1, n
         one = corner(:, i) - mean
         next = corner(:, merge(1, i + 1, i == n)) - mean
         piece = dot_product(normal, cross(one, next))
         total = total + piece
         middle = middle + piece * (one + next)
      end do
      if (abs(total) > tiny(1.0_wp)) middle = middle / (3.0_wp * total)
      middle = mean + middle
   end function centre

   !> How far points reach against a direction: the least of their places along it [m]
   pure function lowest(axis, points) result(least)
      real(wp), intent(in) :: axis(3)
      real(wp), intent(in) :: points(:, :)       !! (3, n) [m]
      real(wp) :: least
      integer :: k
      least = huge(1.0_wp)
      do k = 1, size(points, 2)
         least = min(least, dot_product(axis, points(:, k)))
      end do
   end function lowest

   !> Where faces seem to overlap deep: no feature where edges hold the bodies apart by more than the margin, the two
   !> edges that overlap least, -1 where the faces are right
   pure subroutine find_edges(set, one, two, here_one, here_two, depth, margin, size, found)
      type(body_set), intent(in) :: set
      integer, intent(in) :: one
      integer, intent(in) :: two
      real(wp), intent(in) :: here_one(:, :)
      real(wp), intent(in) :: here_two(:, :)
      real(wp), intent(in) :: depth              !! overlap by faces, negative [m]
      real(wp), intent(in) :: margin             !! [m]
      real(wp), intent(in) :: size               !! [m]
      type(patch), intent(inout) :: found
      real(wp) :: a(3), b(3), u(3), v(3), axis(3), between(3), gap, best, high, low, length, s, t, uu, uv, vv, sense
      integer :: f, g, k, i, j, vertex, shift, shift_two

      found%points = -1
      best = depth
      shift = set%parts(one)%vertex_first - 1
      shift_two = set%parts(two)%vertex_first - 1
      associate (first => set%item(set%parts(one)%owner), second => set%item(set%parts(two)%owner))
         between = second%x - first%x
         do f = set%parts(one)%face_first, set%parts(one)%face_last
            do k = set%loop_first(f), set%loop_first(f + 1) - 1
               i = set%loop(k)
               j = set%loop(merge(set%loop_first(f), k + 1, k == set%loop_first(f + 1) - 1))
               if (i > j) cycle                      ! each edge once
               a = here_one(:, i - shift)
               u = here_one(:, j - shift) - a
               do g = set%parts(two)%face_first, set%parts(two)%face_last
                  do vertex = set%loop_first(g), set%loop_first(g + 1) - 1
                     i = set%loop(vertex)
                     j = set%loop(merge(set%loop_first(g), vertex + 1, vertex == set%loop_first(g + 1) - 1))
                     if (i > j) cycle
                     b = here_two(:, i - shift_two)
                     v = here_two(:, j - shift_two) - b
                     axis = cross(u, v)
                     length = norm2(axis)
                     if (length <= 1.0e-3_wp * norm2(u) * norm2(v)) cycle
                     axis = axis / length
                     sense = sign(1.0_wp, dot_product(axis, between))
                     axis = sense * axis
                     high = -lowest(-axis, here_one)
                     low = lowest(axis, here_two)
                     gap = low - high
                     if (gap > margin) then
                        found%points = 0
                        return
                     end if
                     if (gap <= best) cycle
                     ! The edges themselves must be what is farthest along the axis.
                     if (dot_product(axis, a) < high - 1.0e-6_wp * size) cycle
                     if (dot_product(axis, b) > low + 1.0e-6_wp * size) cycle
                     uu = dot_product(u, u)
                     vv = dot_product(v, v)
                     uv = dot_product(u, v)
                     s = (vv * dot_product(u, b - a) - uv * dot_product(v, b - a)) / (uu * vv - uv**2)
                     t = (uv * dot_product(u, b - a) - uu * dot_product(v, b - a)) / (uu * vv - uv**2)
                     best = gap
                     found%points = 1
                     associate (point => found%point(1))
                        point%kind = on_edges
                        point%own = matmul(a - first%x, first%turn)
                        point%along = matmul(u, first%turn)
                        point%normal = matmul(b - second%x, second%turn)
                        point%other = matmul(v, second%turn)
                        point%level = sense
                        point%area = (edge_side * size)**2
                        point%at = matmul(0.5_wp * (a + s * u + b + t * v) - first%x, first%turn)
                     end associate
                  end do
               end do
            end do
         end do
      end associate
   end subroutine find_edges

end module dem3_patch
