!> Rigid bodies in space made of convex polyhedra: shape, place, motion. Knows no contacts.
!>
!> A body's own frame lies in its principal axes: there its inertia is three numbers, and its free rotation is a
!> sequence of turns about them.
module dem3_bodies
   use common_kinds, only : wp
   use common_status, only : status_ok, status_invalid_argument, status_bad_geometry, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: most_corners, body, part, body_set, body_set_new, copy_bodies, place_part, turn_freely, world_inverse, &
      cross, &
      spin_of, load_moment, load_potential

   integer, parameter :: most_corners = 96     !! of a face

   !> A rigid body. Velocity and swing are those of the half step before the current time (leap-frog).
   type :: body
      real(wp) :: x(3) = 0.0_wp                !! centroid [m]
      real(wp) :: turn(3, 3) = 0.0_wp          !! columns: its own axes
      real(wp) :: v(3) = 0.0_wp                !! [m/s]
      real(wp) :: swing(3) = 0.0_wp            !! angular momentum about the centroid [kg m^2/s]
      real(wp) :: p(3) = 0.0_wp                !! velocity predicted for the next half step [m/s]
      real(wp) :: pspin(3) = 0.0_wp            !! and spin [rad/s]
      real(wp) :: spin(3) = 0.0_wp             !! of the half step before, at the present attitude [rad/s]
      real(wp) :: force(3) = 0.0_wp            !! of the contacts [N]
      real(wp) :: moment(3) = 0.0_wp           !! about the centroid [N m]
      real(wp) :: load(3) = 0.0_wp             !! constant force [N]
      !> Sum over its parts of arm, in the own axes, times force: a column for each component of the force [N m]
      real(wp) :: load_arm(3, 3) = 0.0_wp
      real(wp) :: inverse(3, 3) = 0.0_wp       !! inverse of the inertia in the frame of space
      real(wp) :: mass = 0.0_wp                !! [kg]
      real(wp) :: inverse_mass = 0.0_wp        !! 0 for a support
      real(wp) :: inertia(3) = 0.0_wp          !! about its own axes [kg m^2]
      real(wp) :: radius = 0.0_wp              !! farthest vertex from the centroid [m]
      real(wp) :: seen(3) = 0.0_wp             !! place and attitude at the last search
      real(wp) :: seen_turn(3, 3) = 0.0_wp
      real(wp) :: marked(3) = 0.0_wp           !! and at the last mark
      real(wp) :: marked_turn(3, 3) = 0.0_wp
      real(wp) :: rest(3) = 0.0_wp             !! place as drawn, then after settling
      real(wp) :: rest_turn(3, 3) = 0.0_wp     !! attitude as drawn, then after settling
      real(wp) :: work = 0.0_wp                !! done by the ground's body force [J]
      real(wp) :: airborne = 0.0_wp            !! time without contact [s]
      integer :: marks = 0                     !! times that it has moved far enough to look at its contacts anew
      integer :: bounces = 0                   !! times that it has left all that it touched
      logical :: fixed = .false.
      logical :: touched = .false.             !! in this step
      logical :: touching = .false.            !! in the step before
   end type body

   !> One convex polyhedron of a body
   type :: part
      integer :: owner = 0
      integer :: vertex_first = 0, vertex_last = 0
      integer :: face_first = 0, face_last = 0
      real(wp) :: size = 0.0_wp                !! greatest extent [m]
   end type part

   type :: body_set
      type(body), allocatable :: item(:)
      type(part), allocatable :: parts(:)
      real(wp), allocatable :: vertex(:, :)    !! (3, nv) in the frame of the body [m]
      real(wp), allocatable :: here(:, :)      !! (3, nv) in space [m]
      real(wp), allocatable :: normal(:, :)    !! (3, nf) outward, in the frame of the body
      real(wp), allocatable :: level(:)        !! (nf) of the faces along them [m]
      real(wp), allocatable :: area(:)         !! (nf) [m^2]
      integer, allocatable :: loop_first(:)    !! (nf + 1)
      integer, allocatable :: loop(:)          !! vertices of the faces, counter-clockwise from outside
      real(wp) :: size = 0.0_wp                !! least extent of a part of a mobile body [m]
   end type body_set

contains

   !> Bodies from flat arrays; attitudes, vertices in the frames of the bodies
   subroutine body_set_new(centroid, axes, mass, inertia, owner, vertex_first, vertex, face_first, loop_first, loop, &
                           set, status)
      real(wp), intent(in) :: centroid(:, :)       !! (3, bodies) [m]
      real(wp), intent(in) :: axes(:, :, :)        !! (3, 3, bodies) columns: principal axes
      real(wp), intent(in) :: mass(:)              !! (bodies) [kg]; 0 marks a support
      real(wp), intent(in) :: inertia(:, :)        !! (3, bodies) principal [kg m^2]
      integer(c_int), intent(in) :: owner(:)       !! (parts) 1-based
      integer(c_int), intent(in) :: vertex_first(:)   !! (parts + 1)
      real(wp), intent(in) :: vertex(:, :)         !! (3, vertices) [m]
      integer(c_int), intent(in) :: face_first(:)  !! (parts + 1)
      integer(c_int), intent(in) :: loop_first(:)  !! (faces + 1)
      integer(c_int), intent(in) :: loop(:)        !! vertices of the faces, 1-based
      type(body_set), intent(out) :: set
      integer(c_int), intent(out) :: status
      integer :: b, f, k, failed
      real(wp) :: across(3), extent(3), corner(3), one_side(3), next_side(3)

      status = status_invalid_argument
      if (size(face_first) /= size(owner) + 1 .or. size(vertex_first) /= size(owner) + 1) return
      if (any(owner < 1) .or. any(owner > size(mass)) .or. any(loop < 1) .or. any(loop > size(vertex, 2))) return
      if (vertex_first(1) /= 1 .or. face_first(1) /= 1 .or. loop_first(1) /= 1) return
      if (vertex_first(size(vertex_first)) /= size(vertex, 2) + 1) return
      if (loop_first(size(loop_first)) /= size(loop) + 1) return
      if (face_first(size(face_first)) /= size(loop_first)) return
      if (any(loop_first(2:) - loop_first(:size(loop_first) - 1) < 3)) return
      allocate (set%item(size(mass)), set%parts(size(owner)), set%vertex(3, size(vertex, 2)), &
         set%here(3, size(vertex, 2)), set%normal(3, size(loop_first) - 1), &
         set%level(size(loop_first) - 1), set%area(size(loop_first) - 1), &
         set%loop_first(size(loop_first)), set%loop(size(loop)), stat=failed)
      status = status_out_of_memory
      if (failed /= 0) return
      status = status_bad_geometry
      if (any(loop_first(2:) - loop_first(:size(loop_first) - 1) > most_corners)) return
      set%vertex(:, :) = vertex
      set%loop_first(:) = loop_first
      set%loop(:) = loop
      do b = 1, size(mass)
         associate (item => set%item(b))
            item%x = centroid(:, b)
            item%turn = axes(:, :, b)
            item%rest = item%x
            item%rest_turn = item%turn
            item%mass = mass(b)
            item%inertia = inertia(:, b)
            item%fixed = .not. mass(b) > 0.0_wp
            if (item%fixed) cycle
            if (.not. all(inertia(:, b) > 0.0_wp)) return
            item%inverse_mass = 1.0_wp / mass(b)
            call world_inverse(item)
         end associate
      end do
      do f = 1, size(set%normal, 2)
         across = 0.0_wp
         corner = vertex(:, loop(loop_first(f)))
         do k = loop_first(f) + 1, loop_first(f + 1) - 2
            one_side = vertex(:, loop(k)) - corner
            next_side = vertex(:, loop(k + 1)) - corner
            across = across + cross(one_side, next_side)
         end do
         if (.not. norm2(across) > 0.0_wp) return
         set%normal(:, f) = across / norm2(across)
         set%area(f) = 0.5_wp * norm2(across)
         set%level(f) = 0.0_wp
         do k = loop_first(f), loop_first(f + 1) - 1
            set%level(f) = set%level(f) + dot_product(set%normal(:, f), vertex(:, loop(k))) &
               / (loop_first(f + 1) - loop_first(f))
         end do
      end do
      set%size = huge(1.0_wp)
      do k = 1, size(owner)
         set%parts(k) = part(int(owner(k)), int(vertex_first(k)), int(vertex_first(k + 1)) - 1, int(face_first(k)), &
            int(face_first(k + 1)) - 1)
         associate (one => set%parts(k))
            if (one%vertex_last - one%vertex_first < 3 .or. one%face_last - one%face_first < 3) return
            extent = maxval(vertex(:, one%vertex_first:one%vertex_last), dim=2) &
               - minval(vertex(:, one%vertex_first:one%vertex_last), dim=2)
            one%size = maxval(extent)
            if (.not. minval(extent) > 0.0_wp) return
            if (.not. set%item(one%owner)%fixed) set%size = min(set%size, minval(extent))
            set%item(one%owner)%radius = max(set%item(one%owner)%radius, &
               maxval(norm2(vertex(:, one%vertex_first:one%vertex_last), dim=1)))
         end associate
         call place_part(set, k)
      end do
      if (set%size > 0.5_wp * huge(1.0_wp)) return
      status = status_ok
   end subroutine body_set_new

   !> A copy of some bodies. The assignment of the language would end the process where memory fails.
   subroutine copy_bodies(from, to, status)
      type(body_set), intent(in) :: from
      type(body_set), intent(out) :: to
      integer(c_int), intent(out) :: status        !! status_out_of_memory, else ok
      integer :: failed
      allocate (to%item(size(from%item)), to%parts(size(from%parts)), to%vertex(3, size(from%vertex, 2)), &
         to%here(3, size(from%here, 2)), to%normal(3, size(from%normal, 2)), to%level(size(from%level)), &
         to%area(size(from%area)), to%loop_first(size(from%loop_first)), to%loop(size(from%loop)), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      to%item(:) = from%item
      to%parts(:) = from%parts
      to%vertex(:, :) = from%vertex
      to%here(:, :) = from%here
      to%normal(:, :) = from%normal
      to%level(:) = from%level
      to%area(:) = from%area
      to%loop_first(:) = from%loop_first
      to%loop(:) = from%loop
      to%size = from%size
   end subroutine copy_bodies

   !> Vertices of a part in space
   pure subroutine place_part(set, number)
      type(body_set), intent(inout) :: set
      integer, intent(in) :: number
      integer :: k
      associate (one => set%parts(number))
         do k = one%vertex_first, one%vertex_last
            set%here(:, k) = set%item(one%owner)%x + matmul(set%item(one%owner)%turn, set%vertex(:, k))
         end do
      end associate
   end subroutine place_part

   !> Free rotation over a time: turns about the own axes, halves before and after the third (a symmetric splitting,
   !> which keeps the swing exactly and its energy in bounds: Dullweber, Leimkuhler and McLachlan 1997)
   pure subroutine turn_freely(b, step)
      type(body), intent(inout) :: b
      real(wp), intent(in) :: step              !! [s]
      real(wp) :: own(3)
      integer, parameter :: order(5) = [1, 2, 3, 2, 1]
      integer :: k
      real(wp) :: share
      own = matmul(transpose(b%turn), b%swing)
      do k = 1, 5
         share = merge(1.0_wp, 0.5_wp, k == 3)
         call turn_about(order(k), share * step * own(order(k)) / b%inertia(order(k)), b%turn, own)
      end do
      call world_inverse(b)
   end subroutine turn_freely

   !> Turn about an own axis; the swing, which rests in space, turns back in the own frame
   pure subroutine turn_about(axis, angle, turn, own)
      integer, intent(in) :: axis
      real(wp), intent(in) :: angle             !! [rad]
      real(wp), intent(inout) :: turn(3, 3)
      real(wp), intent(inout) :: own(3)
      integer :: i, j
      real(wp) :: c, s, column(3), number
      if (.not. abs(angle) > 0.0_wp) return
      i = mod(axis, 3) + 1
      j = mod(axis + 1, 3) + 1
      c = cos(angle)
      s = sin(angle)
      column = turn(:, i)
      turn(:, i) = c * column + s * turn(:, j)
      turn(:, j) = c * turn(:, j) - s * column
      number = own(i)
      own(i) = c * number + s * own(j)
      own(j) = c * own(j) - s * number
   end subroutine turn_about

   !> Inverse inertia in space
   pure subroutine world_inverse(b)
      type(body), intent(inout) :: b
      integer :: k
      real(wp) :: scaled(3, 3)
      do k = 1, 3
         scaled(:, k) = b%turn(:, k) / b%inertia(k)
      end do
      b%inverse = matmul(scaled, transpose(b%turn))
   end subroutine world_inverse

   !> Spin that belongs to a swing at the present attitude [rad/s]
   pure function spin_of(b, swing) result(spin)
      type(body), intent(in) :: b
      real(wp), intent(in) :: swing(3)          !! [kg m^2/s]
      real(wp) :: spin(3)
      spin = matmul(b%inverse, swing)
   end function spin_of

   !> Moment of the constant forces, whose places rotate with the body, about the centroid [N m]
   pure function load_moment(b) result(moment)
      type(body), intent(in) :: b
      real(wp) :: moment(3)
      real(wp) :: arm(3, 3)
      arm = matmul(b%turn, b%load_arm)
      moment = [arm(2, 3) - arm(3, 2), arm(3, 1) - arm(1, 3), arm(1, 2) - arm(2, 1)]
   end function load_moment

   !> Potential of these forces at a place and at the attitude of the body, over that at rest [J]
   pure function load_potential(b, x) result(energy)
      type(body), intent(in) :: b
      real(wp), intent(in) :: x(3)              !! [m]
      real(wp) :: energy
      ! The trace of the arms is the sum of arm times force.
      energy = -dot_product(b%load, x - b%rest) - sum((b%turn - b%rest_turn) * transpose(b%load_arm))
   end function load_potential

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3)
      real(wp), intent(in) :: b(3)
      real(wp) :: c(3)
      c = [a(2) * b(3) - a(3) * b(2), a(3) * b(1) - a(1) * b(3), a(1) * b(2) - a(2) * b(1)]
   end function cross

end module dem3_bodies
