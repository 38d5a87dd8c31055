!> Where two convex polyhedra overlap: the corners of the polygon that their faces share, with gap and area of each; or,
!> where edges cross, one point.
!>
!> The face along whose normal the bodies overlap least is the reference; the other body's face that looks against it is
!> cut to the reference's outline. Each corner carries what of the polygon lies nearer to it, seen from its middle: of a
!> rectangle a quarter, so that a plane problem drawn out has the points of the plane, twice.
module dem3_patch
   use common_kinds, only : wp
   use dem3_bodies, only : body_set, cross
   implicit none
   private
   public :: patch, most_points, meet

   integer, parameter :: most_points = 48
   !> Of the size of the lesser part: faces that overlap deeper are asked for edges that cross
   real(wp), parameter :: deep = 2.0e-3_wp
   !> Of the same: side of the square that a point where edges cross stands for
   real(wp), parameter :: edge_side = 0.05_wp
   !> Of the same: corners nearer than this are one. Where edges lie on each other rounding makes two of one.
   real(wp), parameter :: same = 1.0e-3_wp

   type :: patch
      integer :: points = 0
      real(wp) :: normal(3) = 0.0_wp             !! from the first part to the second
      real(wp) :: at(3, most_points) = 0.0_wp    !! [m]
      real(wp) :: gap(most_points) = 0.0_wp      !! negative where they overlap [m]
      real(wp) :: area(most_points) = 0.0_wp     !! [m^2]
   end type patch

contains

   !> The overlap of parts one and two
   pure subroutine meet(set, one, two, found)
      type(body_set), intent(in) :: set
      integer, intent(in) :: one
      integer, intent(in) :: two
      type(patch), intent(out) :: found
      real(wp) :: least_one, least_two, size
      integer :: face_one, face_two

      call least_overlap(set, one, two, least_one, face_one)
      if (least_one >= 0.0_wp) return
      call least_overlap(set, two, one, least_two, face_two)
      if (least_two >= 0.0_wp) return
      size = min(set%parts(one)%size, set%parts(two)%size)
      if (max(least_one, least_two) < -deep * size) then
         call edges(set, one, two, max(least_one, least_two), size, found)
         if (found%points >= 0) return
         found%points = 0
      end if
      if (least_one >= least_two - 1.0e-9_wp * size) then
         call share(set, one, face_one, two, 1.0_wp, found)
      else
         call share(set, two, face_two, one, -1.0_wp, found)
      end if
   end subroutine meet

   !> The face of a part along whose normal the other overlaps it least: that overlap, negative [m], or a gap
   pure subroutine least_overlap(set, part, other, least, face)
      type(body_set), intent(in) :: set
      integer, intent(in) :: part
      integer, intent(in) :: other
      real(wp), intent(out) :: least
      integer, intent(out) :: face
      real(wp) :: normal(3), depth, level
      integer :: f, k
      least = -huge(1.0_wp)
      face = set%parts(part)%face_first
      do f = set%parts(part)%face_first, set%parts(part)%face_last
         normal = matmul(set%item(set%parts(part)%owner)%turn, set%normal(:, f))
         level = dot_product(normal, set%here(:, set%loop(set%loop_first(f))))
         depth = huge(1.0_wp)
         do k = set%parts(other)%vertex_first, set%parts(other)%vertex_last
            depth = min(depth, dot_product(normal, set%here(:, k)) - level)
            if (depth <= least) exit
         end do
         if (depth > least) then
            least = depth
            face = f
            if (least >= 0.0_wp) return
         end if
      end do
   end subroutine least_overlap

   !> The polygon that the reference face shares with the face of the other part that looks against it
   pure subroutine share(set, part, face, other, sense, found)
      type(body_set), intent(in) :: set
      integer, intent(in) :: part              !! of the reference face
      integer, intent(in) :: face
      integer, intent(in) :: other
      real(wp), intent(in) :: sense            !! 1 where the reference belongs to the first part
      type(patch), intent(inout) :: found
      real(wp) :: normal(3), inward(3), start(3), along(3), kept(3, most_points), next(3, most_points), against, least
      real(wp) :: side(most_points), level
      integer :: f, k, n, m, i, j, facing

      normal = matmul(set%item(set%parts(part)%owner)%turn, set%normal(:, face))
      least = huge(1.0_wp)
      facing = set%parts(other)%face_first
      do f = set%parts(other)%face_first, set%parts(other)%face_last
         against = dot_product(normal, matmul(set%item(set%parts(other)%owner)%turn, set%normal(:, f)))
         if (against < least) then
            least = against
            facing = f
         end if
      end do
      n = 0
      do k = set%loop_first(facing), set%loop_first(facing + 1) - 1
         if (n == most_points) exit
         n = n + 1
         kept(:, n) = set%here(:, set%loop(k))
      end do
      do k = set%loop_first(face), set%loop_first(face + 1) - 1
         start = set%here(:, set%loop(k))
         j = merge(set%loop_first(face), k + 1, k == set%loop_first(face + 1) - 1)
         along = set%here(:, set%loop(j)) - start
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
            end if
            if (side(i) >= 0.0_wp .and. m < most_points) then
               m = m + 1
               next(:, m) = kept(:, i)
            end if
         end do
         n = m
         kept(:, :n) = next(:, :n)
         if (n < 3) return
      end do
      m = 0
      do i = 1, n
         if (m > 0) then
            if (norm2(kept(:, i) - found%at(:, m)) < same * set%parts(part)%size) cycle
            if (i == n .and. norm2(kept(:, i) - found%at(:, 1)) < same * set%parts(part)%size) cycle
         end if
         m = m + 1
         found%at(:, m) = kept(:, i)
      end do
      if (m < 3) return
      n = m
      found%points = n
      found%normal = sense * normal
      level = dot_product(normal, set%here(:, set%loop(set%loop_first(face))))
      found%gap(:n) = matmul(normal, found%at(:, :n)) - level
      call areas(normal, found)
   end subroutine share

   !> What each corner carries of the polygon
   pure subroutine areas(normal, found)
      real(wp), intent(in) :: normal(3)
      type(patch), intent(inout) :: found
      real(wp) :: middle(3), piece
      integer :: i, j
      found%area(:found%points) = 0.0_wp
      middle = sum(found%at(:, :found%points), dim=2) / found%points
      do i = 1, found%points
         j = merge(1, i + 1, i == found%points)
         piece = 0.5_wp * abs(dot_product(normal, cross(found%at(:, i) - middle, found%at(:, j) - middle)))
         found%area(i) = found%area(i) + 0.5_wp * piece
         found%area(j) = found%area(j) + 0.5_wp * piece
      end do
   end subroutine areas

   !> Where faces seem to overlap deep: no point where edges hold the bodies apart, one where edges overlap least, -1
   !> where the faces are right
   pure subroutine edges(set, one, two, depth, size, found)
      type(body_set), intent(in) :: set
      integer, intent(in) :: one
      integer, intent(in) :: two
      real(wp), intent(in) :: depth            !! overlap by faces, negative [m]
      real(wp), intent(in) :: size             !! [m]
      type(patch), intent(inout) :: found
      real(wp) :: a(3), b(3), u(3), v(3), axis(3), between(3), gap, best, high, low, length, s, t, uu, uv, vv
      integer :: f, g, k, i, j, vertex

      found%points = -1
      best = depth
      between = set%item(set%parts(two)%owner)%x - set%item(set%parts(one)%owner)%x
      do f = set%parts(one)%face_first, set%parts(one)%face_last
         do k = set%loop_first(f), set%loop_first(f + 1) - 1
            i = set%loop(k)
            j = set%loop(merge(set%loop_first(f), k + 1, k == set%loop_first(f + 1) - 1))
            if (i > j) cycle                      ! each edge once
            a = set%here(:, i)
            u = set%here(:, j) - a
            do g = set%parts(two)%face_first, set%parts(two)%face_last
               do vertex = set%loop_first(g), set%loop_first(g + 1) - 1
                  i = set%loop(vertex)
                  j = set%loop(merge(set%loop_first(g), vertex + 1, vertex == set%loop_first(g + 1) - 1))
                  if (i > j) cycle
                  b = set%here(:, i)
                  v = set%here(:, j) - b
                  axis = cross(u, v)
                  length = norm2(axis)
                  if (length <= 1.0e-3_wp * norm2(u) * norm2(v)) cycle
                  axis = axis / length
                  if (dot_product(axis, between) < 0.0_wp) axis = -axis
                  high = maxval(matmul(axis, set%here(:, set%parts(one)%vertex_first:set%parts(one)%vertex_last)))
                  low = minval(matmul(axis, set%here(:, set%parts(two)%vertex_first:set%parts(two)%vertex_last)))
                  gap = low - high
                  if (gap >= 0.0_wp) then
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
                  found%normal = axis
                  found%at(:, 1) = 0.5_wp * (a + s * u + b + t * v)
                  found%gap(1) = gap
                  found%area(1) = (edge_side * size)**2
               end do
            end do
         end do
      end do
   end subroutine edges

end module dem3_patch
