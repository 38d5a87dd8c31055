!> Discrete elements of the plane: blocks behind a handle, built in steps, and what a run leaves of them.
!>
!> create, laws (api_dem_run), joints, start, loads, moves, surroundings; then the run (api_dem_run); then bodies and contacts.
!> Body numbers are 1-based; mass 0 marks a support.
module api_dem
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: create, joints, start, loads, moves, surroundings, bodies, contacts

contains

   !> Bodies made of convex parts
   subroutine create(nb, npart, nvert, centroid, mass, inertia, owner, first, vertex, outer, handle, status)
      use dem_plane_handle, only : blocks_new
      integer(c_int), intent(in) :: nb                        !! bodies
      integer(c_int), intent(in) :: npart                     !! convex parts
      integer(c_int), intent(in) :: nvert                     !! vertices of all parts
      real(c_double), intent(in) :: centroid(2, nb)           !! [m]
      real(c_double), intent(in) :: mass(nb)                  !! [kg]
      real(c_double), intent(in) :: inertia(nb)               !! [kg m^2]
      integer(c_int), intent(in) :: owner(npart)              !! body of each part
      integer(c_int), intent(in) :: first(npart + 1)          !! first vertex of each part
      real(c_double), intent(in) :: vertex(2, nvert)          !! [m]
      integer(c_int), intent(in) :: outer(nvert)              !! 1: the edge that starts here is on the outline
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      call blocks_new(centroid, mass, inertia, owner, first, vertex, outer, handle, status)
   end subroutine create

   !> Joints with a type of their own
   subroutine joints(handle, njoint, pair, law, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_plane_handle, only : built_blocks, blocks_take, set_joints
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: njoint
      integer(c_int), intent(in) :: pair(2, njoint)           !! bodies
      integer(c_int), intent(in) :: law(njoint)               !! type, 1-based
      integer(c_int), intent(out) :: status
      type(built_blocks), pointer :: built
      call blocks_take(handle, built, status)
      if (status /= status_ok) return
      call set_joints(built, pair, law, status)
      call handle_leave(handle)
   end subroutine joints

   !> Initial displacement and velocity about the centroids
   subroutine start(handle, nb, shift, rate, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem_plane_handle, only : built_blocks, blocks_take, set_start
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nb                        !! bodies
      real(c_double), intent(in) :: shift(3, nb)              !! x, y [m], rotation [rad]
      real(c_double), intent(in) :: rate(3, nb)               !! [m/s, rad/s]
      integer(c_int), intent(out) :: status
      type(built_blocks), pointer :: built
      call blocks_take(handle, built, status)
      if (status /= status_ok) return
      if (nb /= size(built%set%item)) status = status_invalid_argument
      if (status == status_ok) call set_start(built, shift, rate)
      call handle_leave(handle)
   end subroutine start

   !> Constant loads
   subroutine loads(handle, nb, load, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem_plane_handle, only : built_blocks, blocks_take
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nb                        !! bodies
      real(c_double), intent(in) :: load(4, nb)               !! force x, y [N], moment about the centroid, arm times force [N m]
      integer(c_int), intent(out) :: status
      type(built_blocks), pointer :: built
      integer :: k
      call blocks_take(handle, built, status)
      if (status /= status_ok) return
      if (nb /= size(built%set%item)) status = status_invalid_argument
      if (status == status_ok) then
         do k = 1, nb
            built%set%item(k)%load = load(:, k)
         end do
      end if
      call handle_leave(handle)
   end subroutine loads

   !> Supports that move
   subroutine moves(handle, nmove, body, move, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_plane_handle, only : built_blocks, blocks_take
      use dem_loading, only : accept_moves
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nmove
      integer(c_int), intent(in) :: body(nmove)               !! support that moves
      real(c_double), intent(in) :: move(5, nmove)            !! dx, dy [m], turn [rad], start, duration [s]
      integer(c_int), intent(out) :: status
      type(built_blocks), pointer :: built
      call blocks_take(handle, built, status)
      if (status /= status_ok) return
      call accept_moves(built%load, body, move, built%set%item%fixed, status)
      call handle_leave(handle)
   end subroutine moves

   !> Gravity, the ground, the scene
   subroutine surroundings(handle, gravity, mass_damping, moving_base, domain, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem_plane_handle, only : built_blocks, blocks_take
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: gravity(2)                !! [m/s^2]
      real(c_double), intent(in) :: mass_damping              !! alpha [1/s]
      integer(c_int), intent(in) :: moving_base               !! 1: the supports move, 0: body force
      real(c_double), intent(in) :: domain(4)                 !! left, right, bottom, top [m]
      integer(c_int), intent(out) :: status
      type(built_blocks), pointer :: built
      call blocks_take(handle, built, status)
      if (status /= status_ok) return
      if (mass_damping >= 0.0_c_double) then
         built%gravity = gravity
         built%load%moving_base = moving_base /= 0
         built%mass_damping = mass_damping
         built%domain = domain
      else
         status = status_invalid_argument
      end if
      call handle_leave(handle)
   end subroutine surroundings

   !> The bodies at the end of the last run
   subroutine bodies(handle, nb, settled, bounces, airborne, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem_plane_handle, only : blocks_run_take
      use dem_plane_run, only : block_simulation
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nb                        !! bodies
      real(c_double), intent(out) :: settled(3, nb)           !! place after settling: x, y [m], rotation [rad]
      integer(c_int), intent(out) :: bounces(nb)              !! times contact was lost
      real(c_double), intent(out) :: airborne(nb)             !! [s]
      integer(c_int), intent(out) :: status
      type(block_simulation), pointer :: run
      settled = 0.0_c_double
      bounces = 0
      airborne = 0.0_c_double
      call blocks_run_take(handle, run, status)
      if (status /= status_ok) return
      associate (item => run%model%set%item)
         status = merge(status_ok, status_invalid_argument, nb == size(item))
         if (status == status_ok) then
            settled(1, :) = item%rest_x
            settled(2, :) = item%rest_y
            settled(3, :) = item%rest_angle
            bounces = int(item%bounces, c_int)
            airborne = item%airborne
         end if
      end associate
      call handle_leave(handle)
   end subroutine bodies

   !> Contact points closed at the end of the last run
   subroutine contacts(handle, room, body, value, found, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem_plane_handle, only : blocks_run_take, closed_contacts
      use dem_plane_run, only : block_simulation
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: room                      !! for so many of them
      integer(c_int), intent(out) :: body(2, room)
      !> x, y [m], force on the second body x, y [N], normal, shear [N]
      real(c_double), intent(out) :: value(6, room)
      integer(c_int), intent(out) :: found                    !! so many there are
      integer(c_int), intent(out) :: status
      type(block_simulation), pointer :: run
      integer :: closed
      body = 0
      value = 0.0_c_double
      found = 0
      call blocks_run_take(handle, run, status)
      if (status /= status_ok) return
      call closed_contacts(run%model, body, value, closed)
      found = int(closed, c_int)
      call handle_leave(handle)
   end subroutine contacts

end module api_dem
