!> The deformed arch and its dynamic thrust line (thesis 5.2.3): forces across every joint from
!> weight and inertia in the deformed configuration.
module arch_dynamic_thrust
   use common_kinds, only : wp, gravity
   use common_small_solve, only : small_solve
   use common_status, only : status_ok, status_bad_geometry
   use arch_four_hinge, only : four_hinge, four_hinge_state, cross, normal, rotate
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: link_of, voussoir_pose, dynamic_thrust

contains

   !> Link that carries a voussoir: 0 ground, 1 AB, 2 BC, 3 CD
   pure function link_of(voussoir, joint) result(link)
      integer, intent(in) :: voussoir        !! 1-based, between joints voussoir-1 and voussoir
      integer(c_int), intent(in) :: joint(4) !! joints of A, B, C, D
      integer :: link
      link = count(voussoir > joint(1:3))
      if (voussoir > joint(4)) link = 0
   end function link_of

   !> Where a point of a link has gone
   pure function displaced(mechanism, state, link, point) result(moved)
      type(four_hinge), intent(in) :: mechanism
      type(four_hinge_state), intent(in) :: state
      integer, intent(in) :: link
      real(wp), intent(in) :: point(2)
      real(wp) :: moved(2)
      moved = point
      if (link > 0) moved = state%pivot(:, link) &
         + rotate(point - mechanism%undeformed_pivot(link), state%cosine(link), state%sine(link))
   end function displaced

   !> Displaced centroid and rotation of every voussoir of the mechanism that rocks to +x
   subroutine voussoir_pose(mechanism, joint, centroid, q, pose, status)
      type(four_hinge), intent(in) :: mechanism
      integer(c_int), intent(in) :: joint(4)     !! joints of A, B, C, D
      real(wp), intent(in) :: centroid(:, :)     !! (2, n) undeformed [m]
      real(wp), intent(in) :: q                  !! rotation of AB [rad]
      real(wp), intent(out) :: pose(:, :)        !! (3, n): x, y [m], rotation [rad]
      integer(c_int), intent(out) :: status      !! status_bad_geometry past the lock
      type(four_hinge_state) :: state
      integer :: i, link

      pose = 0.0_wp
      call mechanism%find_places(q, state)
      status = merge(status_ok, status_bad_geometry, state%closed)
      if (.not. state%closed) return
      do i = 1, size(centroid, 2)
         link = link_of(i, joint)
         pose(1:2, i) = displaced(mechanism, state, link, centroid(:, i))
         if (link > 0) pose(3, i) = atan2(state%sine(link), state%cosine(link))
      end do
   end subroutine voussoir_pose

   !> Forces across all joints of the mechanism that rocks to +x.
   !>
   !> The resultant passes through hinges A, B and C; that it then passes through D as well is the
   !> equation of motion, and its distance from D is returned as the check.
   subroutine dynamic_thrust(mechanism, mass, centroid, inertia, joint, intrados, extrados, &
                             q, v, a, horizontal, vertical, normal_force, shear, position, point, miss, status)
      type(four_hinge), intent(in) :: mechanism
      real(wp), intent(in) :: mass(:)             !! (n) [kg]
      real(wp), intent(in) :: centroid(:, :)      !! (2, n) [m]
      real(wp), intent(in) :: inertia(:)          !! (n) [kg m^2]
      integer(c_int), intent(in) :: joint(4)      !! joints of A, B, C, D
      real(wp), intent(in) :: intrados(:, :)      !! (2, n+1) intrados ends of the joints [m]
      real(wp), intent(in) :: extrados(:, :)      !! (2, n+1) extrados ends [m]
      real(wp), intent(in) :: q                   !! rotation of AB [rad]
      real(wp), intent(in) :: v                   !! its rate [rad/s]
      real(wp), intent(in) :: a                   !! its acceleration [rad/s^2]
      real(wp), intent(in) :: horizontal          !! ground acceleration [m/s^2]
      real(wp), intent(in) :: vertical            !! ground acceleration, up [m/s^2]
      real(wp), intent(out) :: normal_force(:)    !! (n+1) compression [N]
      real(wp), intent(out) :: shear(:)           !! (n+1) along the joint, towards the extrados [N]
      real(wp), intent(out) :: position(:)        !! (n+1) 0 at the intrados, 1 at the extrados
      real(wp), intent(out) :: point(:, :)        !! (2, n+1) where the resultant meets the joint [m]
      real(wp), intent(out) :: miss               !! distance of the resultant from hinge D [m]
      integer(c_int), intent(out) :: status
      type(four_hinge_state) :: state
      real(wp) :: matrix(3, 3), rhs(3), hinge(2, 4), force(2), moment, total(3)
      real(wp) :: ends(2, 2), along(2), moment_i, moment_e, crossing(3, 4), length
      integer :: i, k, n, first, second

      n = size(mass)
      normal_force = 0.0_wp
      shear = 0.0_wp
      position = 0.0_wp
      point = 0.0_wp
      miss = 0.0_wp
      call mechanism%find_places(q, state)
      status = merge(status_ok, status_bad_geometry, state%closed)
      if (.not. state%closed) return

      ! Sums of the body forces left of each hinge: force and moment about the origin.
      total = 0.0_wp
      crossing = 0.0_wp
      do k = 0, n
         do i = 1, 4
            if (joint(i) == k) crossing(:, i) = total
         end do
         if (k < n) total = total + body_force(k + 1)
      end do
      hinge(:, 1) = mechanism%hinge(:, 1)
      hinge(:, 2) = state%pivot(:, 2)
      hinge(:, 3) = displaced(mechanism, state, 3, mechanism%hinge(:, 3))
      hinge(:, 4) = mechanism%hinge(:, 4)
      ! Moment of the joint resultant about each of A, B, C vanishes: unknown force and moment at joint 0.
      do i = 1, 3
         matrix(i, :) = [hinge(2, i), -hinge(1, i), 1.0_wp]
         rhs(i) = -(crossing(3, i) - cross(hinge(:, i), crossing(1:2, i)))
      end do
      call small_solve(matrix, rhs, status)
      if (status /= status_ok) return

      total = rhs
      do k = 0, n
         force = total(1:2)
         moment = total(3)
         if (k == joint(4)) miss = abs(moment - cross(hinge(:, 4), force)) / max(norm2(force), tiny(1.0_wp))
         first = link_of(k, joint)
         second = link_of(k + 1, joint)
         if (k == 0) first = 0
         if (k == n) second = 0
         ends = joint_ends(k, first, second)
         along = ends(:, 2) - ends(:, 1)
         length = norm2(along)
         along = along / length
         ! The voussoirs follow each other clockwise, so the normal into the next one is `along` turned clockwise.
         normal_force(k + 1) = -dot_product(force, normal(along))
         shear(k + 1) = dot_product(force, along)
         moment_i = moment - cross(ends(:, 1), force)
         moment_e = moment - cross(ends(:, 2), force)
         position(k + 1) = moment_i / sign(max(abs(moment_i - moment_e), tiny(1.0_wp)), moment_i - moment_e)
         point(:, k + 1) = ends(:, 1) + position(k + 1) * length * along
         if (k < n) total = total + body_force(k + 1)
      end do

   contains

      !> Weight and inertia of a voussoir: force and its moment about the origin
      pure function body_force(voussoir) result(load)
         integer, intent(in) :: voussoir
         real(wp) :: load(3)
         real(wp) :: acceleration(2), spin, lever(2), across(2), place(2)
         integer :: part

         part = link_of(voussoir, joint)
         place = displaced(mechanism, state, part, centroid(:, voussoir))
         acceleration = 0.0_wp
         spin = 0.0_wp
         if (part > 0) then
            lever = place - state%pivot(:, part)
            across = normal(lever)  ! once: of two calls the compiler makes one whose result it allocates unchecked
            acceleration = a * (state%pivot1(:, part) + state%turn(part) * across) &
               + v**2 * (state%pivot2(:, part) + state%turn2(part) * across - state%turn(part)**2 * lever)
            spin = a * state%turn(part) + v**2 * state%turn2(part)
         end if
         load(1:2) = -mass(voussoir) * (acceleration + [horizontal, vertical + gravity])
         load(3) = cross(place, load(1:2)) - inertia(voussoir) * spin
      end function body_force

      !> Intrados and extrados end of a joint; at a hinge, through the hinge at the mean angle of its faces
      pure function joint_ends(k, first, second) result(pair)
         integer, intent(in) :: k
         integer, intent(in) :: first
         integer, intent(in) :: second
         real(wp) :: pair(2, 2)
         real(wp) :: face(2, 2), held(2), fraction
         integer :: h
         pair(:, 1) = displaced(mechanism, state, first, intrados(:, k + 1))
         pair(:, 2) = displaced(mechanism, state, first, extrados(:, k + 1))
         if (first == second) return
         face(:, 1) = displaced(mechanism, state, second, intrados(:, k + 1))
         face(:, 2) = displaced(mechanism, state, second, extrados(:, k + 1))
         pair = 0.5_wp * (pair + face)
         do h = 1, 4
            if (joint(h) /= k) cycle
            held = mechanism%hinge(:, h) - intrados(:, k + 1)
            fraction = norm2(held) / norm2(extrados(:, k + 1) - intrados(:, k + 1))
            held = pair(:, 1) + fraction * (pair(:, 2) - pair(:, 1))
            pair = pair + spread(hinge(:, h) - held, 2, 2)
         end do
      end function joint_ends

   end subroutine dynamic_thrust

end module arch_dynamic_thrust
