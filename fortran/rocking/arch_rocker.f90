!> The symmetric arch as a rocking structure: the four-hinge mechanism and its mirror image.
module rocking_arch_rocker
   use common_kinds, only : wp
   use common_status, only : status_ok, status_invalid_argument
   use arch_four_hinge, only : four_hinge, four_hinge_new
   use rocking_rocker, only : rocker
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: arch_rocker, arch_rocker_new, arch_parameters

   !> Length of the parameter list: hinges (8), masses (3), centroids (6), inertias (3), restitution
   integer, parameter :: arch_parameters = 21

   type, extends(rocker) :: arch_rocker
      type(four_hinge) :: mechanism
   contains
      procedure :: coefficients
      procedure :: potential
   end type arch_rocker

contains

   !> Set up from the flat parameter list of the facades
   subroutine arch_rocker_new(parameters, body, status)
      real(wp), intent(in) :: parameters(:)    !! see arch_parameters
      type(arch_rocker), intent(out) :: body
      integer(c_int), intent(out) :: status

      status = status_invalid_argument
      if (size(parameters) < arch_parameters) return
      if (.not. (parameters(21) >= 0.0_wp .and. parameters(21) <= 1.0_wp)) return
      call four_hinge_new(reshape(parameters(1:8), [2, 4]), parameters(9:11), &
         reshape(parameters(12:17), [2, 3]), parameters(18:20), body%mechanism, status)
      if (status /= status_ok) return
      body%restitution = parameters(21)
      body%critical = body%mechanism%critical
      ! Beyond twice the critical rotation, or short of the lock, nothing brings the arch back.
      body%limit = min(2.0_wp * body%mechanism%critical, 0.999_wp * body%mechanism%lock)
      call body%set_rest_rate()
   end subroutine arch_rocker_new

   pure subroutine coefficients(model, side, q, m, half_dm, dv, dh, closed)
      class(arch_rocker), intent(in) :: model
      integer, intent(in) :: side
      real(wp), intent(in) :: q
      real(wp), intent(out) :: m
      real(wp), intent(out) :: half_dm
      real(wp), intent(out) :: dv
      real(wp), intent(out) :: dh
      logical, intent(out) :: closed
      if (side /= 0) call model%mechanism%coefficients(q, m, half_dm, dv, dh, closed)
   end subroutine coefficients

   pure function potential(model, side, q) result(v)
      class(arch_rocker), intent(in) :: model
      integer, intent(in) :: side
      real(wp), intent(in) :: q
      real(wp) :: v
      v = 0.0_wp
      if (side /= 0) v = model%mechanism%potential(q)
   end function potential

end module rocking_arch_rocker
