!> Rigid plane bodies made of convex parts: shape, place, motion. Knows no contacts.
module dem_bodies
   use common_kinds, only : wp
   use common_status, only : status_ok, status_invalid_argument, status_bad_geometry, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: body, part, edge, body_set, body_set_new, body_turn, load_moment, load_potential, most_vertices

   !> Vertices of one convex part, at most
   integer, parameter :: most_vertices = 64

   !> A rigid body. Velocities are those of the half step before the current time (leap-frog).
   type :: body
      real(wp) :: x = 0.0_wp, y = 0.0_wp, angle = 0.0_wp       !! centroid [m], rotation [rad]
      real(wp) :: c = 1.0_wp, s = 0.0_wp                       !! cosine and sine of the rotation
      real(wp) :: vx = 0.0_wp, vy = 0.0_wp, spin = 0.0_wp      !! velocity [m/s], [rad/s]
      real(wp) :: px = 0.0_wp, py = 0.0_wp, pspin = 0.0_wp     !! velocity predicted for the next half step
      real(wp) :: fx = 0.0_wp, fy = 0.0_wp, moment = 0.0_wp    !! contact force [N], moment about the centroid [N m]
      !> Constant load: force [N], its moment about the centroid and the sum of arm times force before the body rotates [N m]
      real(wp) :: load(4) = 0.0_wp
      real(wp) :: inverse_mass = 0.0_wp                        !! 0 for a support
      real(wp) :: inverse_inertia = 0.0_wp
      real(wp) :: mass = 0.0_wp                                !! [kg]
      real(wp) :: inertia = 0.0_wp                             !! [kg m^2]
      real(wp) :: radius = 0.0_wp                              !! farthest vertex from the centroid [m]
      real(wp) :: seen_x = 0.0_wp, seen_y = 0.0_wp, seen_angle = 0.0_wp     !! place at the last search
      real(wp) :: rest_x = 0.0_wp, rest_y = 0.0_wp, rest_angle = 0.0_wp     !! place as drawn, then after settling
      real(wp) :: work = 0.0_wp                                !! done by the ground's body force [J]
      real(wp) :: mass_loss = 0.0_wp                           !! taken by mass-proportional damping [J]
      real(wp) :: airborne = 0.0_wp                            !! time without contact [s]
      integer :: bounces = 0                                   !! times contact was lost
      logical :: touched = .false.                             !! in contact in this step
      logical :: touching = .false.                            !! in contact in the step before
      logical :: fixed = .false.
      integer :: number = 0                                    !! its place in the set
   end type body

   !> One convex polygon of a body: edges first..last, counter-clockwise
   type :: part
      integer :: owner = 0
      integer :: first = 0
      integer :: last = 0
   end type part

   !> An edge in the frame of its body, from its start vertex to the next one
   type :: edge
      real(wp) :: x = 0.0_wp, y = 0.0_wp           !! start vertex, from the centroid [m]
      real(wp) :: tx = 0.0_wp, ty = 0.0_wp         !! unit tangent; the outward normal is (ty, -tx)
      real(wp) :: length = 0.0_wp                  !! [m]
      integer :: next = 0                          !! edge that starts where this one ends
      logical :: outer = .true.                    !! false where two parts of one body meet
   end type edge

   type :: body_set
      type(body), allocatable :: item(:)
      type(part), allocatable :: parts(:)
      type(edge), allocatable :: edges(:)
      real(wp) :: size = 0.0_wp                    !! square root of the smallest area of a mobile part [m]
   end type body_set

contains

   !> Bodies from flat arrays; vertices are given in the initial position
   subroutine body_set_new(centroid, mass, inertia, owner, first, vertex, outer, set, status)
      real(wp), intent(in) :: centroid(:, :)        !! (2, bodies) [m]
      real(wp), intent(in) :: mass(:)               !! (bodies) [kg]; 0 marks a support
      real(wp), intent(in) :: inertia(:)            !! (bodies) [kg m^2]
      integer(c_int), intent(in) :: owner(:)        !! (parts) body of each part, 1-based
      integer(c_int), intent(in) :: first(:)        !! (parts + 1) first vertex of each part, 1-based
      real(wp), intent(in) :: vertex(:, :)          !! (2, vertices) counter-clockwise [m]
      integer(c_int), intent(in) :: outer(:)        !! (vertices) 1: the edge that starts here lies on the outline
      type(body_set), intent(out) :: set
      integer(c_int), intent(out) :: status
      integer :: b, p, k, next, failed
      real(wp) :: area, dx, dy

      status = status_invalid_argument
      if (any(owner < 1) .or. any(owner > size(mass)) .or. first(1) /= 1 .or. any(first > size(vertex, 2) + 1)) return
      if (first(size(first)) /= size(vertex, 2) + 1) return
      allocate (set%item(size(mass)), set%parts(size(owner)), set%edges(size(vertex, 2)), stat=failed)
      if (failed /= 0) then
         status = status_out_of_memory
         return
      end if
      do b = 1, size(mass)
         associate (item => set%item(b))
            item%number = b
            item%x = centroid(1, b)
            item%y = centroid(2, b)
            item%rest_x = item%x
            item%rest_y = item%y
            item%mass = mass(b)
            item%inertia = inertia(b)
            item%fixed = .not. mass(b) > 0.0_wp
            if (.not. item%fixed) then
               if (.not. inertia(b) > 0.0_wp) return
               item%inverse_mass = 1.0_wp / mass(b)
               item%inverse_inertia = 1.0_wp / inertia(b)
            end if
         end associate
      end do
      set%size = huge(1.0_wp)
      status = status_bad_geometry
      do p = 1, size(owner)
         set%parts(p) = part(int(owner(p)), int(first(p)), int(first(p + 1)) - 1)
         if (first(p + 1) - first(p) < 3 .or. first(p + 1) - first(p) > most_vertices) return
         associate (item => set%item(owner(p)))
            area = 0.0_wp
            do k = first(p), first(p + 1) - 1
               next = merge(int(first(p)), k + 1, k == first(p + 1) - 1)
               dx = vertex(1, next) - vertex(1, k)
               dy = vertex(2, next) - vertex(2, k)
               associate (e => set%edges(k))
                  e%x = vertex(1, k) - item%x
                  e%y = vertex(2, k) - item%y
                  e%length = hypot(dx, dy)
                  if (.not. e%length > 0.0_wp) return
                  e%tx = dx / e%length
                  e%ty = dy / e%length
                  e%next = next
                  e%outer = outer(k) /= 0
                  item%radius = max(item%radius, hypot(e%x, e%y))
                  area = area + 0.5_wp * (e%x * dy - e%y * dx)
               end associate
            end do
            if (.not. area > 0.0_wp) return
            if (.not. item%fixed) set%size = min(set%size, sqrt(area))
         end associate
      end do
      if (set%size > 0.5_wp * huge(1.0_wp)) return
      status = status_ok
   end subroutine body_set_new

   !> Cosine and sine from the angle itself: shapes never drift
   elemental subroutine body_turn(b)
      type(body), intent(inout) :: b
      b%c = cos(b%angle)
      b%s = sin(b%angle)
   end subroutine body_turn

   !> Moment about the centroid of constant forces at places that rotate with the body [N m]
   elemental function load_moment(b) result(moment)
      type(body), intent(in) :: b
      real(wp) :: moment
      moment = b%c * b%load(3) - b%s * b%load(4)
   end function load_moment

   !> Potential of these forces at a place and rotation of the body, over that at rest [J]
   pure function load_potential(b, x, y, angle) result(energy)
      type(body), intent(in) :: b
      real(wp), intent(in) :: x          !! [m]
      real(wp), intent(in) :: y          !! [m]
      real(wp), intent(in) :: angle      !! [rad]
      real(wp) :: energy
      energy = -b%load(1) * (x - b%rest_x) - b%load(2) * (y - b%rest_y) &
         - b%load(3) * (sin(angle) - sin(b%rest_angle)) - b%load(4) * (cos(angle) - cos(b%rest_angle))
   end function load_potential

end module dem_bodies
